//! A new folder that appears with everything in it, or not at all.

use std::path::Path;

use super::{FileError, folder_of, new_beside, plain};

/// Makes a folder where nothing is, or an empty one: `fill` writes its files under a temporary name beside it, then it takes its place. What
/// fails leaves nothing behind.
///
/// # Errors
/// Those of `fill`; a place that cannot be written.
pub fn make_folder(path: &Path, fill: impl FnOnce(&Path) -> Result<(), FileError>) -> Result<(), FileError> {
    let failed = |e| FileError::write(path, &e);
    if path.file_name().is_none() {
        return Err(FileError::cannot_write(path, "it is not a folder's name"));
    }
    std::fs::create_dir_all(folder_of(path)).map_err(failed)?;
    let (temporary, ()) = new_beside(path, |at| std::fs::create_dir(at)).map_err(failed)?;
    let made = fill(&temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(failed));
    if made.is_err() {
        let _ = std::fs::remove_dir_all(&temporary);
    }
    made
}

/// Copies a file into a folder that is being made; missing folders on its way are made too.
pub fn copy(from: &Path, to: &Path) -> Result<(), FileError> {
    let failed = |e| FileError::cannot_write(to, format!("copying {} failed: {}", from.display(), plain(&e)));
    std::fs::create_dir_all(folder_of(to)).map_err(failed)?;
    std::fs::copy(from, to).map(drop).map_err(failed)
}

/// Links to a file from a folder that is being made; where the system has no links, it is copied.
pub fn link(from: &Path, to: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder_of(to)).map_err(|e| FileError::write(to, &e))?;
    #[cfg(unix)]
    return std::os::unix::fs::symlink(super::whole_path(from)?, to).map_err(|e| FileError::write(to, &e));
    #[cfg(not(unix))]
    copy(from, to)
}
