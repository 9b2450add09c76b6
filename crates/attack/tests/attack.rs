//! Tests of the crate by its public names, linked once.

#[path = "attack/adam.rs"]
mod adam;
#[path = "attack/difficulty.rs"]
mod difficulty;
#[path = "attack/printer.rs"]
mod printer;
#[path = "attack/resample.rs"]
mod resample;
#[path = "attack/scene.rs"]
mod scene;
#[path = "attack/weights.rs"]
mod weights;
