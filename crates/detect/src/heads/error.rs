//! Why outputs have no boxes to read.

use super::tensor::Tensor;
use scaleproof_core::message::{Message, message};

/// Error of outputs that have no boxes to read.
#[derive(Debug, thiserror::Error)]
pub enum HeadError {
    #[error(transparent)]
    Message(#[from] Message),
    /// A box that is not finite, and in which output.
    #[error("it answered with {0}")]
    NotFinite(String),
}

/// Refuses outputs that are not what the manifest says.
pub(super) fn misfit(kind: &str, expected: String, outputs: &[Tensor]) -> Message {
    let found: Vec<String> = outputs
        .iter()
        .map(|t| format!("{} {:?}", t.name, t.shape).trim_start().to_owned())
        .collect();
    let found = found.join(", ");
    message!("its outputs {found} are not those of a {kind} head ({expected}): the manifest does not fit this file")
}

/// Refuses a label that the manifest does not have.
pub(super) fn strange_label(label: impl std::fmt::Display, labels: usize) -> Message {
    message!(
        "it answered with label {label}, which is not among the {labels} of its manifest: `labels` or `first_label` is another network's"
    )
}
