//! Differentiable detectors: the predictions of a detector for an image, and their derivatives by its pixels.
//!
//! - [`WhiteBox`]: what an attack asks of a detector;
//! - [`program`]: a program as a [`WhiteBox`], whose derivatives are compared with differences first;
//! - [`detector`]: a detector of the program as a [`WhiteBox`], from the ONNX file that scoring runs ([`onnx`]);
//! - [`layers`]: what networks are made of, on plain arrays; [`layers::learning`]: networks whose weights are learnt;
//! - [`adam`]: the steps of weights and of patterns.
//!
//! Images are sRGB, 0 to 1, row by row, as surrogate renderers predict them.
//!
//! ```
//! use scaleproof_core::geometry::BoxPx;
//! use scaleproof_gradients::{MEETS_IOU, strongest};
//!
//! let outline = BoxPx { x1: 10.0, y1: 10.0, x2: 50.0, y2: 30.0 };
//! assert_eq!(strongest(&[], &outline, MEETS_IOU), None);
//! ```

pub mod adam; // steps of the optimiser
mod derivative; // gradients of programs compared with central differences
pub mod detector; // detectors of ONNX files
mod error;
pub mod layers; // layers of networks on plain arrays, forward and backward
pub mod onnx; // ONNX files as networks of layers
pub mod program; // programs that give gradients
pub mod resample; // images into a network's input, and gradients back
pub mod separable; // separable linear maps of images
mod strongest; // losses over the predictions that meet the model
mod whitebox; // what an attack asks of a detector

pub use error::WhiteBoxError;
pub use strongest::{MEETS_IOU, strongest};
pub use whitebox::{Boxes, ForwardPass, ImageLoss, Prediction, WhiteBox};
