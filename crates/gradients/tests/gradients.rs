//! Tests of the differentiable detectors' parts.

#[path = "gradients/activation.rs"]
mod activation;
#[path = "gradients/resample.rs"]
mod resample;
