//! Reasons why the page, or the capture behind it, ends.

use std::io;

use crate::{SourceError, StoreError};

/// What keeps the page, or the capture behind it, from going on.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    #[error("the port {port} cannot be opened ({reason})")]
    Port { port: u16, reason: String },
    #[error("the page cannot be served ({reason})")]
    Server { reason: String },
    #[error("this machine is in no network that a phone could reach")]
    NoNetwork,
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(transparent)]
    Source(#[from] SourceError),
    /// What keeps the pairs from being looked at.
    #[error("{0}")]
    Pairs(String),
    #[error(transparent)]
    Output(io::Error),
}
