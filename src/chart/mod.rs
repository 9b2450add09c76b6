//! Methods against each other, measured on the same photos: the charts that choose the defaults, and the sweeps that show where
//! each method breaks.

pub mod capture;
pub mod envelope;
pub mod locate;
mod spoil;
pub mod stability;
mod timing;
mod truth;

pub use spoil::Spoil;
pub use truth::{TruthError, true_boxes, true_views};
