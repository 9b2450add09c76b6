//! Tests of the differentiable detectors' parts.

#[path = "gradients/activation.rs"]
mod activation;
#[path = "gradients/learning.rs"]
mod learning;
#[path = "gradients/resample.rs"]
mod resample;
