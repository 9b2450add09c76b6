//! Tests of the crate by its public names, linked once.

use scaleproof_testing as common;

#[path = "attack/adam.rs"]
mod adam;
#[path = "attack/attack_onnx.rs"]
mod attack_onnx;
#[path = "attack/attack_onnx_exact.rs"]
mod attack_onnx_exact;
#[path = "attack/camou.rs"]
mod camou;
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
