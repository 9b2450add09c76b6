//! Why detections from outside cannot stand in for a detector.

use scaleproof_core::files::FileError;
use scaleproof_core::message::Message;

/// Error of files of detections that cannot be read or are open to doubt.
#[derive(Debug, thiserror::Error)]
pub enum OutsideError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Message(#[from] Message),
}
