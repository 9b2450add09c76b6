//! DTN, the Differentiable Transformation Network (Suryanto et al., CVPR 2022): it learns what a renderer does to a texture.
//!
//! `x = f(x_ref, η)`: from one image of the view in a reference colour, a convolutional auto-encoder (the Transformation Feature Extractor)
//! makes maps `TF`, and a formula per pixel and channel (the Expected Texture Transformer) applies them to the texture η. `TF` does not see
//! η, so that it cannot learn colours by heart, and it is computed once for all textures of a view.
//!
//! - [`transformer`]: the formula, and NTR's, which only multiplies and adds;
//! - [`network`]: the encoders and the decoder;
//! - [`data`]: training views from frames;
//! - [`training`]: Adam, the loss, the history of its measurements;
//! - [`run`]: training within a budget, saved every half minute;
//! - [`mod@file`]: a network and the state of its training, whole or absent;
//! - [`trained`]: a trained network as a surrogate renderer of one view.
//!
//! Outside the paint the network's input is 0 and nothing is asked of it, so it only ever sees a window around the paint. That costs no accuracy
//! and most of the time less than half.

pub mod data;
pub mod file;
pub mod network;
pub mod run;
pub mod trained;
pub mod training;
pub mod transformer;

pub use network::{Architecture, Encoder};
pub use transformer::Transformer;

use std::path::PathBuf;

use crate::FramesError;
use crate::surrogate::additive::AdditiveError;
use scaleproof_core::files::FileError;

pub const LEAST_WIDTH_PX: u32 = 16;

/// The widths that images of a size can be reduced to, for a sentence.
fn widths([width, height]: [u32; 2]) -> String {
    let factors = (1..=width / LEAST_WIDTH_PX).filter(|f| width.is_multiple_of(*f) && height.is_multiple_of(*f));
    let widths: Vec<String> = factors.map(|factor| (width / factor).to_string()).collect();
    widths.join(", ")
}

/// Why there is no network.
#[derive(Debug, thiserror::Error)]
pub enum DtnError {
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error(transparent)]
    Additive(#[from] AdditiveError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(
        "{folder}: no view has paint, the reference colour {colour} and another flat colour; render flat colours, or name another \
         reference"
    )]
    NoViews { folder: PathBuf, colour: String },
    #[error(
        "{folder}: images of {}×{} pixels cannot be reduced to a width of {asked} by a whole factor of both sides; widths that can be had: {}",
        found[0], found[1], widths(*found)
    )]
    Width {
        folder: PathBuf,
        found: [u32; 2],
        asked: u32,
    },
    #[error("{path} is no network of this program; give a file that attack train-dtn wrote")]
    NotANetwork { path: PathBuf },
    #[error("{path} is damaged: delete it and train again")]
    Damaged { path: PathBuf },
    #[error("{path} was trained with {found}, and not with {asked}: give the same again, or another file")]
    OtherTraining {
        path: PathBuf,
        found: String,
        asked: String,
    },
    #[error(
        "training broke down at step {step}: the loss is no number any more; what was saved before stands. Look at the frames with attack check, or \
         train again with another seed"
    )]
    NotFinite { step: u64 },
    #[error("the network cannot be computed ({0})")]
    Tensor(String),
}
