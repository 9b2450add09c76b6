//! A plan that was fixed before the photos, and in what a comparison differs from it.

mod deviations;
mod judged;
mod plan;
mod views;

pub use plan::{Aim, Endpoint, SealedDetector, SealedFile, SealedPlan, Stopping};
