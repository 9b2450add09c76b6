//! Error of variants that cannot be compared.

use scaleproof_core::message::Message;

/// Reason why nothing can be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    #[error("no photo has the variant `{base}`, only {variants}")]
    NoBase { base: String, variants: String },
    #[error("all photos have the variant `{base}`: add those of another texture")]
    NothingElse { base: String },
    #[error(
        "no photo of `{variant}` was taken from the same place and bin as one of `{base}`: they cannot be compared"
    )]
    NoPair { base: String, variant: String },
    #[error(transparent)]
    Message(#[from] Message),
}
