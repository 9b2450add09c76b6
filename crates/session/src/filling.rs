//! Lock of a session against concurrent runs: the list of one would overwrite the photos of another.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use scaleproof_core::files::{self, FileError};

/// Name of the lock file of the run that fills the session.
pub const MARK: &str = ".capture.lock";

#[derive(Debug, thiserror::Error)]
pub enum FillingError {
    #[error("another run is filling {folder}: end it first", folder = folder.display())]
    InUse { folder: PathBuf },
    #[error(transparent)]
    File(#[from] FileError),
}

/// Locks a session's folder against other runs until the file is closed, at the latest at the end of the process.
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

/// As [`locked`], if a run has ever filled the folder; otherwise nothing is created.
///
/// # Errors
/// As [`locked`].
pub fn locked_if_marked(folder: &Path) -> Result<Option<File>, FillingError> {
    let is_marked = std::fs::symlink_metadata(folder.join(MARK)).is_ok();
    is_marked.then(|| locked(folder)).transpose()
}
