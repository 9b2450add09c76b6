//! Networks with gradients (Cargo feature `attack`).
//!
//! - [`onnx`]: ONNX files on tensors that can be followed backwards;
//! - [`detector`]: a detector of the program as a [`super::white_box::WhiteBox`].

pub mod detector;
pub mod onnx;
mod resample;
