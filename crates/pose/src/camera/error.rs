//! Error of a camera file.

use scaleproof_core::files;
use scaleproof_core::message::Message;

/// Reason why a camera file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error(transparent)]
    Message(#[from] Message),
}
