//! From pictures of a model to a pattern (DTA: Suryanto et al., CVPR 2022).
//!
//! - [`frames`]: the one format of pictures whose truth is known;
//! - [`import`], [`render`] and [`photos`]: its three makers;
//! - [`additive`]: further colours from a few, because light adds up;
//! - [`projection`]: where a pattern's cells lie in a picture, as a linear map;
//! - [`renderer`]: models that predict the picture of the model in any paint;
//! - `dtn` (feature `attack`): those that are trained: DTN and NTR;
//! - [`device`]: what the networks run on;
//! - [`white_box`]: what the attack asks of a detector; `net` (Cargo feature `attack`) answers it with the ONNX file that scoring uses;
//! - [`chart`]: those models against each other;
//! - [`run`]: the attack itself;
//! - [`baseline`]: its rivals;
//! - [`evaluate`]: patterns rendered anew on the model, as photos with exact truth.

pub mod additive;
pub mod baseline;
pub mod chart;
pub mod device;
#[cfg(feature = "attack")]
pub mod dtn;
pub mod evaluate;
pub mod frames;
pub mod import;
pub mod light;
#[cfg(feature = "attack")]
pub mod net;
pub mod photos;
pub mod projection;
#[cfg(feature = "attack")]
mod quietly;
#[cfg(feature = "attack")]
pub use quietly::is_refusing;
pub mod render;
pub mod renderer;
pub mod run;
mod separable;
pub mod white_box;
