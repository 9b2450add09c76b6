//! Paths: folders, names, and places where nothing is.

use std::path::{Path, PathBuf};

use super::error::FileError;

/// Returns a file or folder beside the running program, as in an unpacked archive; `None` when it is not there.
pub fn beside_the_program(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?.canonicalize().ok()?;
    let path = program.parent()?.join(name);
    path.exists().then_some(path)
}

/// Returns the whole path of a file or folder, without links.
pub fn whole_path(path: &Path) -> Result<PathBuf, FileError> {
    path.canonicalize().map_err(|e| FileError::read(path, &e))
}

/// Returns true if two paths lead to one existing file or folder.
pub fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Returns the path if nothing is there, else a numbered one beside it: the output that an advice names.
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

/// Returns the folder that a path lies in; `.` for a mere name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Returns the last part of a path; a path without one stays whole.
pub fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
