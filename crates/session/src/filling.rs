//! Lock of a session against concurrent runs: the list of one would overwrite the photos of another.

use std::fs::{File, TryLockError};
use std::path::Path;

use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail};

/// Name of the lock file of the run that fills the session.
pub const MARK: &str = ".capture.lock";

/// Reason why a session cannot be locked.
#[derive(Debug, thiserror::Error)]
pub enum FillingError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Message(#[from] Message),
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
        Err(TryLockError::WouldBlock) => bail!("another run is filling {}: end it first", folder.display()),
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
