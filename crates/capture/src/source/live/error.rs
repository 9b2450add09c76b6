//! Reasons why a running camera gives nothing.

/// Reason why a running camera gives nothing, as a clause; the source says which camera it is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LiveCameraError {
    /// Asking again may help.
    #[error("{0}")]
    Failed(String),
    /// It will give no more, whatever is tried.
    #[error("{0}")]
    Ended(String),
    /// It may give images again: a sentence.
    #[error("{0}")]
    Waiting(String),
}
