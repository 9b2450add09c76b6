//! Camera models in OpenCV's conventions: pinhole with Brown–Conrady distortion, or fisheye.

mod brown_conrady;
mod chosen;
mod colmap;
mod distortion;
mod error;
mod fields;
mod fisheye;
mod fit;
mod format;
mod guess;
mod kalibr;
mod matrix_yaml;
mod model;
mod mrcal;
mod nerf;
pub mod projection;
mod xml;
pub mod yaml;

pub use distortion::DistortionModel;
pub use error::CameraError;
pub use fit::{FittedCamera, SizeError};
pub use format::CameraFormat;
pub use guess::GuessError;
pub use model::{Camera, Guess};
