//! Error of a camera file.

use super::fault::CameraFault;
use scaleproof_core::files;

/// Reason why a camera file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the camera cannot be written as {format}: {fault}")]
    NotInFormat { format: &'static str, fault: CameraFault },
}
