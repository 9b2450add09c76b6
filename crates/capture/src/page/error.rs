//! Reasons why the page, or the capture behind it, ends.

use std::io;

use crate::{SourceError, StoreError};
use scaleproof_core::message::{Hint, Message};

/// Reason why the page, or the capture behind it, ends.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    #[error("this machine is in no network that a phone could reach")]
    NoNetwork(#[source] Hint),
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error(transparent)]
    Message(#[from] Message),
    /// The pairs cannot be evaluated.
    #[error(transparent)]
    Pairs(Box<dyn std::error::Error>),
    /// The terminal's output cannot be written.
    #[error(transparent)]
    Output(io::Error),
}
