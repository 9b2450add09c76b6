//! Photos corrupted by published amounts, to find out whether an effect survives.
//!
//! Amounts and formulas are those of ImageNet-C (Hendrycks and Dietterich, ICLR 2019), which Michaelis et al. ("Benchmarking Robustness in Object
//! Detection", 2019) applied to photos of COCO's size: [`LONGEST_PX`] along the longer side, to which larger photos are reduced first. `crop` has no
//! published amounts; its own are stated at [`cut_off`].

mod fog;
mod pixels;

use image::RgbImage;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;

use scaleproof_core::geometry::BoxPx;
use scaleproof_photo::{as_jpeg, boxed};

/// Longer side of a photo before it is corrupted, px: larger ones are reduced to it.
pub const LONGEST_PX: u32 = 640;

/// Greatest severity of a corruption, from 1 on; 0 is the reduced photo, no worse.
pub const SEVERITIES: u8 = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corruption {
    /// Out of focus: `defocus_blur`.
    Blur,
    /// `gaussian_noise`.
    Noise,
    /// `jpeg_compression`.
    Jpeg,
    /// Too much light: `brightness`.
    Exposure,
    /// `fog`.
    Haze,
    /// Too few pixels: `pixelate`.
    Scale,
    Crop,
}

impl Corruption {
    pub const ALL: [Self; 7] = [
        Self::Blur,
        Self::Noise,
        Self::Jpeg,
        Self::Exposure,
        Self::Haze,
        Self::Scale,
        Self::Crop,
    ];

    pub fn name(self) -> &'static str {
        ["blur", "noise", "jpeg", "exposure", "haze", "scale", "crop"][self as usize]
    }

    /// Returns the amount of a severity; empty for 0.
    pub fn amount(self, severity: u8) -> String {
        let Some(at) = usize::from(severity).checked_sub(1) else {
            return String::new();
        };
        match self {
            Self::Blur => format!("{} px", DEFOCUS[at].0),
            Self::Noise => format!("{}", NOISE[at]),
            Self::Jpeg => format!("q {}", JPEG[at]),
            Self::Exposure => format!("+{}", EXPOSURE[at]),
            Self::Haze => format!("{} ({})", HAZE[at].0, HAZE[at].1),
            Self::Scale => format!("×{}", SCALE[at]),
            Self::Crop => format!("{} %", CROP[at] * 100.0),
        }
    }

    /// Returns the image at a severity from 1 on, of the same size; a crop is made by [`cut_off`], and leaves the image as it is here. `None` where
    /// no JPEG can be made of it.
    pub fn apply(self, image: &RgbImage, severity: u8, seed: u64) -> Option<RgbImage> {
        let at = usize::from(severity.clamp(1, SEVERITIES)) - 1;
        let mut rng = Pcg32::seed_from_u64(seed);
        Some(match self {
            Self::Blur => pixels::defocused(image, DEFOCUS[at]),
            Self::Noise => pixels::noisy(image, NOISE[at], &mut rng),
            Self::Jpeg => as_jpeg(image, JPEG[at])?,
            Self::Exposure => pixels::brighter(image, EXPOSURE[at]),
            Self::Haze => fog::foggy(image, HAZE[at], &mut rng),
            Self::Scale => pixelated(image, SCALE[at]),
            Self::Crop => image.clone(),
        })
    }
}

/// Radius of the disk, px, and σ of the Gaussian that softens its edge, px.
const DEFOCUS: [(i32, f32); 5] = [(3, 0.1), (4, 0.5), (6, 0.5), (8, 0.5), (10, 0.5)];
/// σ of the noise, where white is 1.
const NOISE: [f64; 5] = [0.08, 0.12, 0.18, 0.26, 0.38];
/// JPEG quality.
const JPEG: [u8; 5] = [25, 18, 15, 10, 7];
/// Amount added to the value of HSV, where white is 1.
const EXPOSURE: [f32; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];
/// Amount of fog, and decay of its finer parts.
const HAZE: [(f32, f64); 5] = [(1.5, 2.0), (2.0, 2.0), (2.5, 1.7), (2.5, 1.5), (3.0, 1.4)];
/// Share of the photo's sides that is kept.
const SCALE: [f64; 5] = [0.6, 0.5, 0.4, 0.3, 0.25];
/// Share of the model's box that is cut off.
const CROP: [f64; 5] = [0.1, 0.2, 0.3, 0.4, 0.5];

/// Returns the part (x1, y1, x2, y2, px) that is left of an image of (width, height) when a share of the model's box is cut off at its left, right,
/// top or bottom, which `seed` chooses: whole pixels, and at least one of the model's.
pub fn cut_off(truth: &BoxPx, [width, height]: [u32; 2], severity: u8, seed: u64) -> [u32; 4] {
    let share = CROP[usize::from(severity.clamp(1, SEVERITIES)) - 1];
    // `from` cuts at the low end, `up_to` at the high end.
    let from = |low: f64, high: f64, side: u32| {
        let last = (high.ceil() as u32).clamp(1, side) - 1;
        ((low + share * (high - low)).round().max(0.0) as u32).min(last)
    };
    let up_to = |low: f64, high: f64, side: u32| {
        let first = (low.floor().max(0.0) as u32).min(side - 1);
        ((high - share * (high - low)).round().max(0.0) as u32).clamp(first + 1, side)
    };
    match Pcg32::seed_from_u64(seed).random_range(0..4) {
        0 => [from(truth.x1, truth.x2, width), 0, width, height],
        1 => [0, 0, up_to(truth.x1, truth.x2, width), height],
        2 => [0, from(truth.y1, truth.y2, height), width, height],
        _ => [0, 0, width, up_to(truth.y1, truth.y2, height)],
    }
}

/// Reduces an image to a share of its sides, and shows each pixel as a block.
fn pixelated(image: &RgbImage, share: f64) -> RgbImage {
    let (width, height) = image.dimensions();
    let [across, down] = [width, height].map(|side| ((f64::from(side) * share) as u32).max(1));
    let small = boxed(image, [across, down]);
    let from = |at: u32, side: u32, small: u32| (u64::from(2 * at + 1) * u64::from(small) / u64::from(2 * side)) as u32;
    RgbImage::from_fn(width, height, |x, y| {
        *small.get_pixel(from(x, width, across), from(y, height, down))
    })
}
