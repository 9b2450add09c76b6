//! Networks of ONNX files on the tensor framework, with gradients (Cargo feature `attack`).

pub mod detector;
mod device;
pub mod onnx;
mod quietly;
pub mod resample;

pub use quietly::is_refusing;
