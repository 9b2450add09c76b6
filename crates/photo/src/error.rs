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
    #[error("{path} is not a JPEG or PNG image: use a photo straight from the camera", path = path.display())]
    NotAnImage { path: PathBuf },
    #[error("{}", heif_sentence(path, kind))]
    Heif { path: PathBuf, kind: &'static str },
    #[error("{path} ends in the middle of the image: copy it from the camera again", path = path.display())]
    Truncated { path: PathBuf },
    #[error("{path} has {size}: scale it down", path = path.display())]
    TooLarge { path: PathBuf, size: String },
    #[error("{path} is a JPEG of {scans} scans, which no camera writes and which take too long to decode: save it again", path = path.display())]
    TooManyScans { path: PathBuf, scans: u64 },
    #[error("{path} cannot be decoded ({reason}): copy it from the camera again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
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

fn heif_sentence(path: &Path, kind: &str) -> String {
    let a = if kind == "AVIF" { "an" } else { "a" };
    format!(
        "{} is {a} {kind} image, for which this system has no decoder: {}",
        path.display(),
        heif_remedy(path, kind)
    )
}
