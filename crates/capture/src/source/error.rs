//! Reasons why a source of frames ends.

use scaleproof_core::message::Message;
use scaleproof_session::SessionError;

/// Reason why a source gives no (more) frames.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Message(#[from] Message),
}
