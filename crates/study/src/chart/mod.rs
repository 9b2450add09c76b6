//! Methods against each other, measured on the same photos: the charts that choose the defaults, and the sweeps that show where
//! each method breaks.

pub mod capture;
pub mod envelope;
pub mod locate;
pub mod score;
mod spoil;
pub mod stability;
mod truth;

use scaleproof_photo::photo::PhotoError;
use scaleproof_pose::camera::SizeError;
use scaleproof_pose::tags::StartError;
pub use spoil::Spoil;
pub use truth::{true_boxes, true_views};

/// Why photos could not be measured on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Size(#[from] SizeError),
}
