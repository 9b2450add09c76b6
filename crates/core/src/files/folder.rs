//! Folders made whole or not at all, and files copied or linked into them.

use std::fs::File;
use std::path::Path;

use super::error::FileError;
use super::path::{folder_of, whole_path};
use super::read::not_a_file;
use super::staged::new_beside;
use super::{error, inputs, journal};

/// Makes the folder that a user named, and those on its way, where they are missing.
pub fn make_named_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(|e| FileError::write(folder, &e))
}

/// Removes a folder that a user named, where nothing lies in it.
pub fn remove_if_empty(folder: &Path) {
    // What cannot be removed is in nobody's way.
    let _ = std::fs::remove_dir(folder);
}

/// Makes a folder where nothing is, or an empty one: `fill` writes its files under a temporary name beside it, then it takes its place. What
/// fails leaves nothing behind.
pub fn make_folder(path: &Path, fill: impl FnOnce(&Path) -> Result<(), FileError>) -> Result<(), FileError> {
    let failed = |e| FileError::write(path, &e);
    if path.file_name().is_none() {
        return Err(FileError::cannot_write(path, "it is not a folder's name"));
    }
    std::fs::create_dir_all(folder_of(path)).map_err(failed)?;
    journal::tidy(folder_of(path));
    let (temporary, ()) = new_beside(path, |at| std::fs::create_dir(at)).map_err(failed)?;
    // Its lock says that this program is at work on it; where folders have no locks, nobody removes what is left behind.
    let lock = File::open(&temporary).ok().filter(|folder| folder.try_lock().is_ok());
    let made = fill(&temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(failed));
    if made.is_err() {
        let _ = std::fs::remove_dir_all(&temporary);
    }
    drop(lock);
    made
}

/// Copies a file into a folder that is being made; missing folders on its way are made too.
pub fn copy(from: &Path, to: &Path) -> Result<(), FileError> {
    let failed = |e| FileError::cannot_write(to, format!("copying {} failed: {}", from.display(), error::plain(&e)));
    std::fs::create_dir_all(folder_of(to)).map_err(failed)?;
    inputs::note(from);
    // Reading a named pipe would wait for ever.
    if !from.metadata().map_err(failed)?.is_file() {
        return Err(FileError::cannot_read(from, not_a_file(from)));
    }
    std::fs::copy(from, to).map(drop).map_err(failed)
}

/// Links to a file from a folder that is being made; where the system has no links, it is copied.
pub fn link(from: &Path, to: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder_of(to)).map_err(|e| FileError::write(to, &e))?;
    #[cfg(unix)]
    return std::os::unix::fs::symlink(whole_path(from)?, to).map_err(|e| FileError::write(to, &e));
    #[cfg(not(unix))]
    copy(from, to)
}
