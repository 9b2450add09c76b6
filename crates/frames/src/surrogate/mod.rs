//! Surrogate renderers: models of one view that predict its image for any paint.
//!
//! - [`additive`]: further colours from a few, because light adds up;
//! - [`projection`]: where a pattern's cells lie in an image, as a linear map;
//! - [`renderer`]: closed forms, fitted to a few images of the view;
//! - [`dtn`]: those that are trained, DTN and NTR;
//! - [`chart`]: those models against each other.

pub mod additive;
pub mod chart;
pub mod dtn;
pub mod projection;
pub mod renderer;
