//! An image made larger or smaller about its middle and moved, as a linear map, forward and transposed.

use super::cells::Rgb;
use scaleproof_gradients::separable::{Separable, Tap};

/// Border of an image that was made smaller: the grey that detectors pad with.
pub const AROUND: f64 = 114.0 / 255.0;

/// Separable map of an image to one of the same size, with a triangle kernel as wide as it takes not to alias. Its transpose is that of the map
/// in it: what surrounds the image is constant.
#[derive(Debug, Clone)]
pub struct Resample(pub Separable);

impl Resample {
    /// Creates the map; `scale` above 1 enlarges, `offset_px` moves right and down.
    pub fn new(size_px: [u32; 2], scale: f64, offset_px: [f64; 2]) -> Self {
        let size = size_px.map(|side| side as usize);
        let [columns, rows] = [0, 1].map(|axis| taps(size[axis], scale, offset_px[axis]));
        Self(Separable::new(size, columns, rows))
    }

    /// Resizes and moves an image.
    pub fn forward(&self, image: &[Rgb]) -> Vec<Rgb> {
        let from_grey: Vec<Rgb> = image.iter().map(|rgb| rgb.map(|v| v - AROUND)).collect();
        let mut augmented = self.0.forward(&from_grey);
        augmented.iter_mut().flatten().for_each(|v| *v += AROUND);
        augmented
    }
}

fn taps(size: usize, scale: f64, offset: f64) -> Vec<Tap> {
    let middle = 0.5 * size as f64;
    let reach = (1.0 / scale).max(1.0);
    let row = |out: usize| {
        let at = middle + (out as f64 + 0.5 - middle - offset) / scale - 0.5;
        let (low, high) = ((at - reach).ceil() as i64, (at + reach).floor() as i64);
        let weight = |i: i64| (1.0 - (i as f64 - at).abs() / reach).max(0.0);
        // Of the whole kernel: what hangs over the border is what surrounds the image.
        let sum: f64 = (low..=high).map(weight).sum();
        let inside = low.max(0)..=high.min(size as i64 - 1);
        // What lies wholly outside sees nothing of the image; its first pixel must still be one.
        let first = usize::try_from(*inside.start()).unwrap_or(0).min(size - 1);
        let weights = inside.map(|i| weight(i) / sum).collect();
        Tap { first, weights }
    };
    (0..size).map(row).collect()
}
