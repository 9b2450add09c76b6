//! A plan that was fixed before the photos, and in what a comparison differs from it.

mod deviations;
mod plan;
mod views;

pub use plan::{SealedDetector, SealedFile, SealedPlan, Stopping};
