//! Environment variables. One that is set to nothing counts as unset, since a shell that clears a variable leaves it so.

use std::ffi::OsString;
use std::path::PathBuf;

/// Returns the value of an environment variable; `None` where it is unset or empty.
pub fn variable(name: &str) -> Option<OsString> {
    std::env::var_os(name).filter(|value| !value.is_empty())
}

/// Returns the text of an environment variable; `None` where it is unset, empty or no Unicode.
pub fn text(name: &str) -> Option<String> {
    variable(name)?.into_string().ok()
}

/// Returns the file of a program, in the first folder of `PATH` that has one of this name.
pub fn program(name: &str) -> Option<PathBuf> {
    let folders = variable("PATH")?;
    let mut places = std::env::split_paths(&folders).map(|folder| folder.join(name));
    places.find(|place| place.is_file())
}
