//! Fields of view and names that imported frames can have.

/// Horizontal fields of view that a pinhole camera can have.
pub(super) const FIELDS_OF_VIEW_DEG: std::ops::RangeInclusive<f64> = 1.0..=170.0;

/// Returns true for a name that a frame can have.
pub(super) fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || "-_.@".contains(c)) && !name.starts_with('.')
}
