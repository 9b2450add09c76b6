//! Error of a session that cannot be opened, made or written.

use crate::envelope::EnvelopeError;
use scaleproof_core::files::FileError;
use scaleproof_core::message::Message;
use scaleproof_photo::PhotoError;
use scaleproof_pose::camera::CameraError;

/// Reason why there is no session.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SessionError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Envelope(#[from] EnvelopeError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Message(#[from] Message),
}
