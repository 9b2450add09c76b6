//! Reasons why a JPEG gives no picture.

/// Reason why there is no picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum JpegError {
    Truncated,
    /// Damage, as a clause.
    Damaged(&'static str),
    /// The coefficients do not fit the memory allowed.
    TooManyValues,
}
