//! Errors of files, as sentences.

use std::path::{Path, PathBuf};

/// A file that could not be read or written, or that holds something else than it should; as a sentence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    #[error("cannot read {path}: {reason}", path = path.display())]
    Read { path: PathBuf, reason: String },
    #[error("cannot write {path}: {reason}", path = path.display())]
    Write { path: PathBuf, reason: String },
    #[error("{path}, line {line}: {message}", path = path.display())]
    Syntax {
        path: PathBuf,
        line: usize,
        message: String,
    },
    #[error("{path}: {message}", path = path.display())]
    Content { path: PathBuf, message: String },
    #[error("{path} is an input, which would be overwritten; give another output file", path = path.display())]
    IsInput { path: PathBuf },
    #[error("two files would be written as {path}; give them different names", path = path.display())]
    Twice { path: PathBuf },
}

impl FileError {
    pub fn content(path: &Path, message: impl ToString) -> FileError {
        let (path, message) = (path.to_owned(), message.to_string());
        FileError::Content { path, message }
    }

    pub fn syntax(path: &Path, line: usize, message: String) -> FileError {
        let path = path.to_owned();
        FileError::Syntax { path, line, message }
    }

    pub fn read(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_read(path, plain(e))
    }

    pub fn write(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_write(path, plain(e))
    }

    /// A file that could not be read, for a reason that is no error of the system.
    pub fn cannot_read(path: &Path, reason: impl Into<String>) -> FileError {
        let (path, reason) = (path.to_owned(), reason.into());
        FileError::Read { path, reason }
    }

    /// A file that could not be written, for a reason that is no error of the system.
    pub fn cannot_write(path: &Path, reason: impl Into<String>) -> FileError {
        let (path, reason) = (path.to_owned(), reason.into());
        FileError::Write { path, reason }
    }
}

/// An operating system error without its "(os error 2)".
pub fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
