//! Reasons why a photo cannot be used.

use std::path::{Path, PathBuf};

use scaleproof_core::files;
use scaleproof_core::spelling::quoted;

/// Reason why a photo could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PhotoError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("{}", sentence(path, problem))]
    Bytes { path: PathBuf, problem: DecodeProblem },
}

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
        let (path, problem) = (path.to_owned(), self);
        PhotoError::Bytes { path, problem }
    }
}

fn sentence(path: &Path, problem: &DecodeProblem) -> String {
    let name = path.display();
    match problem {
        DecodeProblem::NotAnImage => format!("{name} is not a JPEG or PNG image: use a photo straight from the camera"),
        DecodeProblem::Heif(kind) => {
            let (a, remedy) = (if *kind == "AVIF" { "an" } else { "a" }, heif_remedy(path, kind));
            format!("{name} is {a} {kind} image, for which this system has no decoder: {remedy}")
        }
        DecodeProblem::Truncated => format!("{name} ends in the middle of the image: copy it from the camera again"),
        DecodeProblem::TooLarge(size) => format!("{name} has {size}: scale it down"),
        DecodeProblem::TooManyScans(scans) => format!(
            "{name} is a JPEG of {scans} scans, which no camera writes and which take too long to decode: save it again"
        ),
        DecodeProblem::Damaged(reason) => format!("{name} cannot be decoded ({reason}): copy it from the camera again"),
    }
}

pub const IPHONE_TO_JPEG: &str = "set the iPhone to Settings › Camera › Formats › Most Compatible";

/// Returns advice for an HEIC, HEIF or AVIF image, which is read if the system has a decoder for it.
pub fn heif_remedy(path: &Path, kind: &str) -> String {
    let [from, to] =
        [path, &files::free_place(&path.with_extension("jpg"))].map(|path| quoted(&path.to_string_lossy()));
    let phone = if kind == "HEIC" {
        format!("{IPHONE_TO_JPEG}, or ")
    } else {
        String::new()
    };
    format!(
        "{phone}install libheif's decoder (Debian: apt install libheif-examples), with which it is read as it is, or convert it with \
         `heif-dec {from} {to}` (on older systems heif-convert)"
    )
}
