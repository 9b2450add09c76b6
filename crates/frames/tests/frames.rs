//! Tests of the crate by its public names, linked once.

#[path = "frames/blender.rs"]
mod blender;
#[path = "frames/contrast.rs"]
mod contrast;
#[path = "frames/training.rs"]
mod training;
