//! What is wrong with the bytes of an image.

use std::path::Path;

use super::PhotoError;

/// What is wrong with the bytes of an image.
#[derive(Debug, PartialEq)]
pub enum DecodeProblem {
    NotAnImage,
    /// Its kind.
    Heif(&'static str),
    Truncated,
    /// How large, as a clause.
    TooLarge(String),
    TooManyScans(u64),
    Damaged(String),
}

impl DecodeProblem {
    pub(super) fn at(self, path: &Path) -> PhotoError {
        let path = path.to_owned();
        match self {
            DecodeProblem::NotAnImage => PhotoError::NotAnImage { path },
            DecodeProblem::Heif(kind) => PhotoError::Heif { path, kind },
            DecodeProblem::Truncated => PhotoError::Truncated { path },
            DecodeProblem::TooLarge(size) => PhotoError::TooLarge { path, size },
            DecodeProblem::TooManyScans(scans) => PhotoError::TooManyScans { path, scans },
            DecodeProblem::Damaged(reason) => PhotoError::Damaged { path, reason },
        }
    }
}
