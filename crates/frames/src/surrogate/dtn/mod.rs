//! DTN, the Differentiable Transformation Network (Suryanto et al., CVPR 2022): it learns what a renderer does to a texture.
//!
//! `x = f(x_ref, η)`: from one image of the view in a reference colour, a convolutional auto-encoder (the Transformation Feature Extractor)
//! makes maps `TF`, and a formula per pixel and channel (the Expected Texture Transformer) applies them to the texture η. `TF` does not see
//! η, so that it cannot learn colours by heart, and it is computed once for all textures of a view.
//!
//! Outside the paint the network's input is 0 and nothing is asked of it, so it only ever sees a window around the paint. That costs no accuracy
//! and most of the time less than half.

pub mod data; // training views from frames
pub mod file; // a network and the state of its training, whole or absent
pub mod network; // the encoders and the decoder
pub mod run; // training within a budget, saved every half minute
pub mod trained; // a trained network as a surrogate renderer of one view
pub mod training; // Adam, the loss, the history of its measurements
pub mod transformer; // the formula, and NTR's, which only multiplies and adds

pub use data::LEAST_WIDTH_PX;
pub use network::{Architecture, Encoder};
pub use transformer::Transformer;
