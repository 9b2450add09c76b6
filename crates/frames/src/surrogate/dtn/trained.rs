//! A trained network as a surrogate renderer of one view.

use image::RgbImage;

use super::Transformer;
use super::data::{PaintPixels, PaintWindow};
use super::network::{Architecture, LayerShapes};
use super::transformer::Maps;
use crate::surrogate::renderer::Renderer;
use crate::{Coverage, light};

/// Trained network.
#[derive(Debug, Clone)]
pub struct DtnNetwork {
    pub architecture: Architecture,
    /// Reference colours, 8-bit sRGB, that it was trained to start from; it takes an image in any of them.
    pub references: Vec<[u8; 3]>,
    /// Time spent on its training, s.
    pub training_seconds: f64,
    pub(super) weights: Vec<Vec<f32>>,
}

impl DtnNetwork {
    /// Computes TF of each paint pixel, `channels` values each, from the sRGB of those pixels in the reference image.
    pub(super) fn maps(&self, paint: &PaintPixels, reference: &[[f32; 3]]) -> Vec<f32> {
        let window = PaintWindow::around(&[paint]);
        let mut input = vec![0.0; 3 * window.pixels()];
        let at = window.middle(paint);
        window.fill(&mut input, paint, at, reference);
        let maps = LayerShapes::new(self.architecture)
            .network(&self.weights, window.size())
            .output(input);
        let channels = self.architecture.transformer.channels();
        let (maps, pixels) = (&maps, window.pixels());
        let of_pixel = |place: usize| (0..channels).map(move |c| maps[c * pixels + place]);
        window.places(paint, at).flat_map(of_pixel).collect()
    }

    /// Prepares the surrogate renderer of a view, from its image in a reference colour and the paint's coverage, of one size.
    pub fn view(&self, reference: &RgbImage, mask: &Coverage) -> DtnView {
        let paint = PaintPixels::covered(mask);
        let image: Vec<[f64; 3]> = reference.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
        let number = |[x, y]: &[u32; 2]| (y * mask.width() + x) as usize;
        let index: Vec<usize> = paint.at.iter().map(number).collect();
        let seen: Vec<[f32; 3]> = index.iter().map(|i| image[*i].map(|v| v as f32)).collect();
        let maps = if index.is_empty() {
            Vec::new()
        } else {
            self.maps(&paint, &seen)
        };
        DtnView {
            transformer: self.architecture.transformer,
            image,
            index,
            maps,
        }
    }
}

/// Surrogate renderer of one view: its maps. Outside the paint the image is the reference's.
#[derive(Debug, Clone)]
pub struct DtnView {
    transformer: Transformer,
    image: Vec<[f64; 3]>,
    /// The index of each paint pixel in the image.
    index: Vec<usize>,
    maps: Vec<f32>,
}

impl DtnView {
    /// Returns an image with `value` of the maps and η, the sRGB of the reflectance, in each channel of each paint pixel.
    fn filled(&self, mut image: Vec<[f64; 3]>, paint: &[[f64; 3]], value: impl Fn(Maps, f64) -> f64) -> Vec<[f64; 3]> {
        let maps = self.maps.chunks_exact(self.transformer.channels());
        for (maps, &at) in maps.zip(&self.index) {
            image[at] = std::array::from_fn(|channel| {
                let maps = self.transformer.maps(channel, |i| f64::from(maps[i]));
                value(maps, light::encode(paint[at][channel]))
            });
        }
        image
    }
}

impl Renderer for DtnView {
    fn predict(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let value = |maps, eta| self.transformer.value(maps, eta).clamp(0.0, 1.0);
        self.filled(self.image.clone(), paint, value)
    }

    fn derivative(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.filled(vec![[0.0; 3]; self.image.len()], paint, |maps, eta| {
            let value = self.transformer.value(maps, eta);
            if value <= 0.0 || value >= 1.0 {
                return 0.0;
            }
            // The chain through η.
            self.transformer.derivative(maps, eta) / light::decode_derivative(eta)
        })
    }
}
