//! Differentiable detectors: the predictions of a detector for an image, and their derivatives by its pixels.
//!
//! - [`WhiteBox`]: what an attack asks of a detector;
//! - [`detector`] (Cargo feature `attack`): a detector of the program as a [`WhiteBox`], from the ONNX file that scoring runs;
//! - [`onnx`] (Cargo feature `attack`): ONNX files on tensors with gradients;
//! - [`device`]: what the networks run on.
//!
//! Images are sRGB, 0 to 1, row by row, as renderer models predict them.

#[cfg(feature = "attack")]
pub mod detector;
pub mod device;
#[cfg(feature = "attack")]
pub mod onnx;
#[cfg(feature = "attack")]
mod quietly;
#[cfg(feature = "attack")]
mod resample;
pub(crate) mod separable;

#[cfg(feature = "attack")]
pub use quietly::is_refusing;

use crate::geometry::BoxPx;

/// What one anchor of a detector says about the classes that count as the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// In pixels of the picture.
    pub box_px: BoxPx,
    /// Highest confidence C of the classes that count, 0 to 1.
    pub confidence: f64,
    /// `−ln(1 − C)`, the term of DTA's attack loss (CVPR 2022, eq. 7), finite for every C.
    pub loss: f64,
}

/// A detector that can be followed back to its picture.
pub trait WhiteBox {
    /// The name of its manifest.
    fn name(&self) -> &str;

    /// The overlap above which a better box hides another in scoring.
    fn hides_from_iou(&self) -> f64;

    /// All anchors, without suppression of neighbours and without a floor.
    ///
    /// # Errors
    /// What the network cannot do with this picture, as a sentence.
    fn look(&self, picture: &[[f64; 3]], size_px: [u32; 2]) -> Result<Box<dyn Look + '_>, String>;

    /// The claims alone, where no derivative will be asked for.
    ///
    /// # Errors
    /// Those of [`WhiteBox::look`].
    fn claims(&self, picture: &[[f64; 3]], size_px: [u32; 2]) -> Result<Vec<Claim>, String> {
        Ok(self.look(picture, size_px)?.claims().to_vec())
    }
}

/// A detector's answer about one picture.
pub trait Look {
    fn claims(&self) -> &[Claim];

    /// The derivative of `Σ weight · loss` with respect to each value of the picture; one weight a claim.
    fn pull_back(self: Box<Self>, weights: &[f64]) -> Vec<[f64; 3]>;
}
