//! Limits of a scene's size.

/// Maximum number of tags; more were written by a program, and take minutes to pair up on cards.
pub(super) const MOST_TAGS: u64 = 2000;
/// Maximum number of bins.
pub(super) const MOST_BINS: usize = 100_000;
