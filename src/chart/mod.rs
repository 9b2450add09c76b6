//! Methods against each other, measured on the same photos: the charts that choose the defaults, and the sweeps that show where
//! each method breaks.

pub(crate) mod capture;
pub(crate) mod envelope;
pub(crate) mod locate;
pub(crate) mod score;
mod spoil;
pub(crate) mod stability;
mod truth;

use crate::camera::SizeError;
use crate::photo::PhotoError;
use crate::tags::StartError;

#[cfg(test)]
pub(crate) use spoil::Spoil;
pub(crate) use truth::{true_boxes, true_views};

/// Why photos could not be measured on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum MeasureError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Size(#[from] SizeError),
}
