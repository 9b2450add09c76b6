//! Texts of files.

use std::path::Path;

use scaleproof_core::files::{self, FileError};

/// The text of a file, and the file's name with its SHA-256.
pub(super) fn hashed_text(path: &Path) -> Result<(String, (String, String)), FileError> {
    let text = files::read_text(path)?;
    let sha256 = files::sha256_hex(text.as_bytes());
    Ok((text, (files::name_of(path), sha256)))
}

/// Creates the error of invalid JSON, with its line.
pub(super) fn syntax(path: &Path, e: &serde_json::Error) -> FileError {
    let text = e.to_string();
    let message = text.split(" at line ").next().unwrap_or(&text);
    FileError::syntax(path, e.line(), message.to_owned())
}
