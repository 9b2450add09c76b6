//! Differentiable detectors: what an attack asks of them, and what they give.

use serde::Serialize;

use crate::WhiteBoxError;
use scaleproof_core::geometry::BoxPx;

/// The boxes that an attack works against, among those that meet the model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Boxes {
    /// The most confident one, as DTA does.
    #[default]
    Strongest,
    /// All, by the sum of their odds.
    All,
    /// All, each weighted with its overlap with the model.
    Overlap,
}

impl Boxes {
    /// All, the default first.
    pub const ALL: [Self; 3] = [Self::Strongest, Self::All, Self::Overlap];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        ["strongest", "all", "overlap"][self as usize]
    }
}

/// The prediction of one anchor about the classes that count as the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    pub box_px: BoxPx,
    /// Highest confidence C of the classes that count, 0 to 1.
    pub confidence: f64,
    /// `−ln(1 − C)`, the term of DTA's attack loss (CVPR 2022, eq. 7), finite for every C.
    pub loss: f64,
    /// No class that does not count has a higher score in this box, so that scoring reports it as the model and not as something else. True for all
    /// of a pass that keeps its backward pass: an attack on nothing but what is reported lets go too early (`docs/lessons/attack.md`).
    pub is_reported: bool,
}

/// A differentiable detector.
pub trait WhiteBox {
    fn name(&self) -> &str;

    /// The overlap above which a better box hides another in scoring.
    fn nms_iou(&self) -> f64;

    /// All anchors, without suppression of neighbours and without a floor; of a program those that it keeps.
    ///
    /// # Errors
    /// An image that the detector cannot look at.
    fn predictions(&self, image: &[[f64; 3]], size_px: [u32; 2]) -> Result<Vec<Prediction>, WhiteBoxError>;

    /// The loss of the predictions that meet `outline`, the box around the model: of the strongest, or of all; `None` where none meets it.
    ///
    /// # Errors
    /// Those of [`WhiteBox::predictions`].
    fn loss_and_gradient(
        &self,
        image: &[[f64; 3]],
        size_px: [u32; 2],
        outline: &BoxPx,
        boxes: Boxes,
    ) -> Result<Option<ImageLoss>, WhiteBoxError>;

    /// Itself, where several threads may look through it at a time: each looks as if it were alone. `None` where one look follows another.
    fn shared(&self) -> Option<&(dyn WhiteBox + Sync)> {
        None
    }
}

/// The loss of an image, and its gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageLoss {
    /// `−ln(1 − C)`.
    pub loss: f64,
    /// C.
    pub confidence: f64,
    /// Derivative of the loss with respect to each value of the image.
    pub gradient: Vec<[f64; 3]>,
}

/// The predictions for an image, with the backward pass from their losses.
pub trait ForwardPass {
    fn predictions(&self) -> &[Prediction];

    /// The derivative of `Σ weight · loss` with respect to each value of the image; one weight a prediction.
    fn vjp(self: Box<Self>, weights: &[f64]) -> Vec<[f64; 3]>;
}
