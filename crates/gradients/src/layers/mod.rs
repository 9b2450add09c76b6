//! Layers of a network on plain arrays, for one image: forward, and back with respect to their inputs.
//!
//! Shapes and weights are known when a layer is made, so it keeps for the backward pass only what depends on the image. A layer works on the
//! thread that calls it: whoever has several images gives each a thread.

pub mod activation; // functions of each number
mod by_weights; // convolutions whose weights are learnt
pub mod convolution; // convolutions as products of matrices
mod depthwise; // convolutions of each channel
mod layer;
pub mod learning; // networks whose weights are learnt
pub mod lines; // sums, means, extremes and softmax along an axis
pub mod matrix; // products of matrices
pub mod moved; // numbers put elsewhere
pub mod number; // numbers of 32 or 64 bits
pub mod pairwise; // two arrays, number by number
pub mod pool; // the largest number of each window
pub mod sampled; // images between their pixels
pub mod separate; // linear maps of rows and of columns
pub mod tape; // steps between slots, and their backward passes
pub mod transposed; // transposed convolutions
pub mod windows; // windows on an image, and weights

pub use activation::{Activation, Each, sigmoid};
pub use convolution::convolution;
pub use layer::{Array, Back, Layer, Sums, owned, vectorised};
pub use lines::{Lines, Reduced, Softmax, Summary};
pub use matrix::Product;
pub use moved::Moved;
pub use number::Number;
pub use pairwise::{Operation, Pairwise};
pub use pool::MaxPool;
pub use sampled::Sampled;
pub use separate::Separate;
pub use transposed::Transposed;
pub use windows::{Weights, Windows};
