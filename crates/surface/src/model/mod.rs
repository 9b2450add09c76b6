//! The model that a command works on: its mesh in the model frame, which of it is paint, its scale.

mod read; // a model from its mesh's file, with what is known of it
pub mod vehicle; // usual lengths of vehicles, and how they lie

#[cfg(feature = "full")]
pub use read::Reduction;
pub use read::{Model, ModelError, ModelRequest, PaintedMesh, painted};
