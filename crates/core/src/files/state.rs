//! State of a file when it was read.

use std::path::{Path, PathBuf};

use super::error::FileError;

/// A file at a path: which one, its length, and when its content and its entry changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileState {
    path: PathBuf,
    about: Vec<i128>,
}

impl FileState {
    /// Takes the state of a file, before it is read.
    pub fn of(path: &Path) -> Result<FileState, FileError> {
        let about = path.metadata().map_err(|e| FileError::read(path, &e))?;
        let path = path.to_owned();
        #[cfg(unix)]
        let about = {
            use std::os::unix::fs::MetadataExt;
            let numbers = [about.mtime(), about.mtime_nsec(), about.ctime(), about.ctime_nsec()];
            let which = [about.dev(), about.ino(), about.len()].map(i128::from);
            which.into_iter().chain(numbers.map(i128::from)).collect()
        };
        #[cfg(not(unix))]
        let about = {
            let changed = about
                .modified()
                .ok()
                .and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
            vec![
                i128::from(about.len()),
                changed.map_or(0, |time| time.as_nanos() as i128),
            ]
        };
        Ok(FileState { path, about })
    }

    /// Refuses a file that is another one by now, or was written to: what was read of it may be of two.
    pub fn check(&self) -> Result<(), FileError> {
        match FileState::of(&self.path)? == *self {
            true => Ok(()),
            false => Err(FileError::content(
                &self.path,
                "it changed while it was read: call this again when it is whole",
            )),
        }
    }
}
