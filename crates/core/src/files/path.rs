//! Paths: folders, names, and places where nothing is.

use std::path::{Path, PathBuf};

use super::error::FileError;

/// A file or folder that lies beside the running program, as in an unpacked archive; `None` when it is not there.
pub fn beside_the_program(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?.canonicalize().ok()?;
    let path = program.parent()?.join(name);
    path.exists().then_some(path)
}

/// The whole path of a file or folder, without links.
pub fn whole_path(path: &Path) -> Result<PathBuf, FileError> {
    path.canonicalize().map_err(|e| FileError::read(path, &e))
}

/// Whether two paths lead to one file or folder that is there.
pub fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The path where nothing is there, else one numbered beside it: what an advice names as an output.
pub fn free_place(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().display();
    let ending = path
        .extension()
        .map_or(String::new(), |ending| format!(".{}", ending.display()));
    let numbered = (2..).map(|number| path.with_file_name(format!("{stem}_{number}{ending}")));
    let mut places = std::iter::once(path.to_owned()).chain(numbered);
    places
        .find(|place| place.symlink_metadata().is_err())
        .unwrap_or_default()
}

/// The folder that a path lies in; `.` for a mere name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// The last part of a path; a path without one stays whole.
pub fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
