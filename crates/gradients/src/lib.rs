//! Differentiable detectors: the predictions of a detector for an image, and their derivatives by its pixels.
//!
//! - [`WhiteBox`]: what an attack asks of a detector;
//! - [`program`]: a program as a [`WhiteBox`], whose derivatives are held against differences first;
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

pub mod adam;
mod derivative;
pub mod detector;
mod fault;
pub mod layers;
pub mod onnx;
pub mod program;
pub mod resample;
pub mod separable;
mod strongest;

pub use fault::NetworkFault;
pub use strongest::{Boxes, MEETS_IOU, strongest};

use scaleproof_core::files::FileError;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::ProgramError;

/// Why a detector cannot be attacked through its own network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WhiteBoxError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{name} cannot be differentiated: {reason}")]
    Detector { name: String, reason: Box<WhiteBoxError> },
    #[error("{file} cannot be differentiated: {reason}")]
    OnnxNetwork { file: String, reason: NetworkFault },
    #[error("{file} has operators that cannot be differentiated here: {names}; attack another detector")]
    Operators { file: String, names: String },
    #[error("{file} failed: {reason}")]
    Run { file: String, reason: NetworkFault },
    #[error("labels {labels:?} are not among its {count}; name those that count as the model")]
    Labels { labels: Vec<usize>, count: usize },
    #[error("the size of its input depends on the image; attack a detector with an input of its own size")]
    InputOfAnySize,
    #[error("it takes images of 8 bits, and no gradient passes their rounding")]
    EightBits,
    #[error("{found} pixels are no image of {} × {}", size_px[0], size_px[1])]
    Pixels { found: usize, size_px: [u32; 2] },
    #[error("{name} answered with NaN in its output {output}")]
    NotANumber { name: String, output: String },
    /// What its head says of its outputs.
    #[error("{0}")]
    Head(String),
    #[error("its head expects logits, and the network answers with probabilities: correct the manifest's head")]
    Probabilities,
    #[error("its head chooses boxes by itself, and no gradient passes the choice; attack another detector")]
    ChosenBoxes,
    #[error(transparent)]
    Program(#[from] ProgramError),
    #[error("{name} gives no gradients, and this differentiates it: let its hello have \"gradients\": true")]
    NoGradients { name: String },
    #[error(
        "{name} takes photos as files, and here are images that lie in none: let the input of its hello be \"rgb\""
    )]
    NoPixels { name: String },
    #[error("{name} gives the loss of its strongest box alone, and all boxes were asked for")]
    StrongestAlone { name: String },
    /// What is wrong with the gradient of a program.
    #[error("{0}")]
    Gradient(String),
}

/// What one anchor of a detector says about the classes that count as the model.
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
    /// What the detector cannot do with this image.
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

#[derive(Debug, Clone, PartialEq)]
pub struct ImageLoss {
    /// `−ln(1 − C)`.
    pub loss: f64,
    /// C.
    pub confidence: f64,
    /// Derivative of the loss with respect to each value of the image.
    pub gradient: Vec<[f64; 3]>,
}

pub trait ForwardPass {
    fn predictions(&self) -> &[Prediction];

    /// The derivative of `Σ weight · loss` with respect to each value of the image; one weight a prediction.
    fn vjp(self: Box<Self>, weights: &[f64]) -> Vec<[f64; 3]>;
}
