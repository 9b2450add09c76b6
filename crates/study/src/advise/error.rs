//! Reasons why nothing can be advised.

use scaleproof_core::message::Message;
use scaleproof_pose::tags::StartError;

/// Reason why nothing can be advised.
#[derive(Debug, thiserror::Error)]
pub enum AdviseError {
    #[error(transparent)]
    Start(#[from] StartError),
    #[error(transparent)]
    Message(#[from] Message),
}
