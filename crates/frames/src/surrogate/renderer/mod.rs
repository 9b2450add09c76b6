//! Models of one view that predict its image for any paint, behind one interface.
//!
//! All are closed forms: fitted per pixel and channel to a few images in flat colours by least squares, rendered or photographed, without
//! training. DTN (`x = relu((relu(η − s) + a)·m + b)`, CVPR 2022, fig. 4) is affine per pixel where its ReLUs are open, so these are its
//! rivals by construction. They work channel by channel: a camera that mixes channels is beyond them.
//!
//! | model | image x of reflectance ρ |
//! |---|---|
//! | `affine` | x = a + b·η, both as sRGB |
//! | `quadratic` | x = a + b·η + c·η², both as sRGB |
//! | `affine-curve` | T⁻¹(x) = a + b·ρ, in light, with the image's tone curve T fitted ([`Tone`]) |
//! | `quadratic-curve` | T⁻¹(x) = a + b·ρ + c·ρ²: light that goes to and fro between the paint's parts as well |

mod per_pixel;
mod tone;

pub use per_pixel::PerPixel;
pub use tone::Tone;

use image::RgbImage;

use crate::{Coverage, Frame, FrameSet, FramesError};

#[derive(Debug, Clone)]
pub struct FlatImage {
    /// 8-bit sRGB of the paint's reflectance.
    pub flat_rgb: [u8; 3],
    pub image: RgbImage,
}

impl FlatImage {
    /// The image of a frame; `None` where its paint is not of one colour.
    pub fn read(set: &FrameSet, frame: &Frame) -> Result<Option<Self>, FramesError> {
        let read = |flat_rgb| set.rgb(frame).map(|image| Self { flat_rgb, image });
        frame.flat_rgb().map(read).transpose()
    }
}

pub trait Renderer {
    /// `paint`: linear reflectance of the paint in each pixel, row by row. The result is sRGB, 0 to 1.
    fn predict(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]>;

    /// The derivative of each predicted value with respect to the reflectance in the same pixel and channel; it depends on no other. 0 where
    /// the prediction is clipped.
    fn derivative(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]>;
}

/// A model that was trained beforehand, and needs one image of a view.
pub trait NeuralRenderer {
    fn name(&self) -> String;

    /// 8-bit sRGB reflectances: the image must be in one of them.
    fn references(&self) -> &[[u8; 3]];

    fn training_seconds(&self) -> f64;

    /// The model of a view, from its image in a reference colour and the paint's coverage, of one size.
    ///
    /// # Errors
    /// Why tensors cannot be computed, as a sentence.
    fn of_view(&self, reference: &RgbImage, mask: &Coverage) -> Result<Box<dyn Renderer>, String>;
}

/// Which model. The default is the most accurate of `attack chart`; where only two colours are at hand, `affine-curve` is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedForm {
    Affine,
    Quadratic,
    AffineCurve,
    #[default]
    QuadraticCurve,
}

impl ClosedForm {
    pub const ALL: [Self; 4] = [Self::Affine, Self::Quadratic, Self::AffineCurve, Self::QuadraticCurve];

    pub fn name(self) -> &'static str {
        ["affine", "quadratic", "affine-curve", "quadratic-curve"][self as usize]
    }

    /// Fewest colours, different in all three channels.
    pub fn least_colours(self) -> usize {
        match self {
            Self::Affine | Self::AffineCurve => 2,
            Self::Quadratic | Self::QuadraticCurve => 3,
        }
    }
}

/// Why a model could not be fitted.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    #[error(
        "the {model} model needs images in {needed} flat colours that differ in every channel, and there are {found}: `attack render --flat 000000 808080 ffffff` makes three, in a new folder"
    )]
    TooFew {
        model: &'static str,
        needed: usize,
        found: usize,
    },
    #[error("the images of a view have different sizes; take them with the same camera")]
    Sizes,
    #[error("more than {most} flat colours of a view are of no use; give fewer")]
    TooMany { most: usize },
}
