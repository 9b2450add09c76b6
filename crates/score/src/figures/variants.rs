//! Variants of a run: the base, and patterns that were not optimised.

use crate::figures::ScoredPhoto;

/// Returns the variants present, the base variant first.
pub(crate) fn variants(photos: &[ScoredPhoto], base: &str) -> Vec<String> {
    let mut variants: Vec<String> = photos.iter().map(|p| p.variant.clone()).collect();
    variants.sort_by_key(|v| (v != base, v.clone()));
    variants.dedup();
    variants
}

/// Variant of the model without a pattern.
pub const BASE_VARIANT: &str = "normal";

/// Returns true if a variant is a pattern that was not optimised, by its name.
pub(crate) fn is_control(variant: &str) -> bool {
    let name = variant.to_lowercase();
    CONTROLS.iter().any(|control| name.contains(control))
}

/// Words in the names of patterns that were not optimised.
const CONTROLS: [&str; 3] = ["random", "control", "noise"];
