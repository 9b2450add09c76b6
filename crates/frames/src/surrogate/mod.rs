//! Surrogate renderers: models of one view that predict its image for any paint.

pub mod additive; // further colours from a few, because light adds up
pub mod chart; // the models compared on the same frames
pub mod dtn; // trained models: DTN and NTR
pub mod projection; // where a pattern's cells lie in an image, as a linear map
pub mod renderer; // closed forms, fitted to a few images of the view
