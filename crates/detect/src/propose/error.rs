//! Why no manifest can be proposed.

use crate::{DetectError, ManifestError};
use scaleproof_core::files::FileError;
use scaleproof_core::message::Message;

/// Error of a file that no manifest can be proposed for.
#[derive(Debug, thiserror::Error)]
pub enum ProposeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Detect(#[from] DetectError),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error(transparent)]
    Message(#[from] Message),
}
