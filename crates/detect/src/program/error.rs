//! Why a program gave no answer.

use std::sync::Arc;

use scaleproof_core::files::FileError;
use scaleproof_core::message::{Message, message};

/// Error of a detector that is a program or a function.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    #[error(transparent)]
    Message(#[from] Message),
    /// The program says that it gives no answer about this image.
    #[error(transparent)]
    Declined(Message),
    #[error(transparent)]
    File(#[from] FileError),
    /// The error that all threads get which wait for the same program.
    #[error(transparent)]
    Lost(Arc<ProgramError>),
}

/// Refuses an answer about a file that breaks the protocol.
pub(crate) fn untrusted(detector: &str, file: &str, fault: String) -> Message {
    message!("the answer of {detector} about {file} cannot be trusted: {fault}")
}
