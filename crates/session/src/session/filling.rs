//! Which run fills a session: one at a time, or the list of one would forget the photos of another.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use scaleproof_core::files::{self, FileError};

/// Its lock says that a run is filling the session.
pub const MARK: &str = ".capture.lock";

#[derive(Debug, thiserror::Error)]
pub enum FillingError {
    #[error("another run is filling {folder}: end it first", folder = folder.display())]
    InUse { folder: PathBuf },
    #[error(transparent)]
    File(#[from] FileError),
}

/// Keeps other runs out of a session's folder until the file is closed, at the latest with the process, however that ends.
///
/// # Errors
/// Another run is filling it; a folder that cannot be written.
pub fn locked(folder: &Path) -> Result<File, FillingError> {
    let path = folder.join(MARK);
    let file = files::chosen::mark(folder, &path)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let folder = folder.to_owned();
            Err(FillingError::InUse { folder })
        }
        Err(TryLockError::Error(e)) => Err(FileError::write(&path, &e).into()),
    }
}

/// As [`locked`], where a run has ever filled the folder; nothing is made where none has.
///
/// # Errors
/// As [`locked`].
pub fn locked_if_marked(folder: &Path) -> Result<Option<File>, FillingError> {
    let is_marked = std::fs::symlink_metadata(folder.join(MARK)).is_ok();
    is_marked.then(|| locked(folder)).transpose()
}
