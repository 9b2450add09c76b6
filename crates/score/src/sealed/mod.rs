//! Plan that was fixed before the photos, and deviations of a comparison from it.

mod deviations;
mod judged;
mod plan;
mod views;

pub use plan::{Aim, Endpoint, SealedDetector, SealedFile, SealedPlan, Stopping};
