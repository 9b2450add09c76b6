//! Faults in the bytes of an image.

use std::path::Path;

use super::error::PhotoError;

/// Fault in the bytes of an image, as a clause.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum DecodeProblem {
    #[error("it is no image")]
    NotAnImage,
    #[error("it is an image of the kind {0}")]
    Heif(&'static str),
    #[error("it ends in the middle of the image")]
    Truncated,
    /// Size of the image, as a clause.
    #[error("it has {0}")]
    TooLarge(String),
    #[error("it has {0} scans")]
    TooManyScans(u64),
    #[error("{0}")]
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
