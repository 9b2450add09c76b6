//! Errors of files, as sentences.

use std::path::Path;

use crate::message::{Message, message};

/// Error of a file that cannot be read or written, or that holds something else than it should.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct FileError(#[from] Message);

impl From<FileError> for Message {
    fn from(error: FileError) -> Message {
        error.0
    }
}

impl FileError {
    pub fn content(path: &Path, message: impl ToString) -> FileError {
        message!("{}: {}", path.display(), message.to_string()).into()
    }

    pub fn syntax(path: &Path, line: usize, message: String) -> FileError {
        message!("{}, line {line}: {message}", path.display()).into()
    }

    pub fn read(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_read(path, plain(e))
    }

    pub fn write(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_write(path, plain(e))
    }

    /// Creates the error of a file that could not be read, for a reason that is no error of the system.
    pub fn cannot_read(path: &Path, reason: impl Into<String>) -> FileError {
        message!("cannot read {}: {}", path.display(), reason.into()).into()
    }

    /// Creates the error of a file that could not be written, for a reason that is no error of the system.
    pub fn cannot_write(path: &Path, reason: impl Into<String>) -> FileError {
        message!("cannot write {}: {}", path.display(), reason.into()).into()
    }

    /// Creates the error of an output in the place of an input.
    pub(super) fn is_input(path: &Path) -> FileError {
        let path = path.display();
        message!("{path} is an input, which would be overwritten; give another output file").into()
    }
}

/// Returns the text of an operating system's error without its "(os error 2)".
pub fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
