//! Convolutions whose weights are learnt: back with respect to them, too.

use super::convolution::Convolution;
use super::layer::{Array, Back, Layer, Sums};
use super::matrix::{Matrix, multiply};
use super::windows::{Weights, Windows};

/// The derivatives by weights and biases are added to the sums of its second and third input.
pub(super) struct LearntConvolution {
    convolution: Convolution<f32>,
    /// True where the derivative by the image is asked for, too.
    by_image: bool,
}

impl LearntConvolution {
    pub(super) fn new(windows: Windows, weights: Weights, by_image: bool) -> Self {
        let convolution = Convolution { windows, weights };
        Self { convolution, by_image }
    }
}

impl Layer for LearntConvolution {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let image = inputs[0].clone();
        let (output, by_image) = self.convolution.forward(inputs, keeps);
        let back = by_image.map(|by_image| -> Back<'_> {
            Box::new(move |gradient, sums| {
                self.convolution.by_weights(&image, &gradient, sums);
                if self.by_image {
                    by_image(gradient, sums);
                }
            })
        });
        (output, back)
    }
}

impl Convolution<f32> {
    /// The product of the output's derivatives with the windows, transposed: a weight meets the same place of every window.
    fn by_weights(&self, image: &[f32], gradient: &[f32], sums: &mut Sums) {
        let (w, area) = (&self.windows, self.windows.area());
        let weights = sums.sum_mut(1, self.weights.weights.len());
        let mut columns = Vec::new();
        for tile in self.tiles() {
            let size = tile.rows.len() * w.count[1];
            let images = self.windows_of(image, &tile, &mut columns);
            let outputs = Matrix::rows(&gradient[self.output(&tile)..], area);
            let of_group = &mut weights[tile.group * self.group_outputs() * self.inner()..];
            let sides = [self.group_outputs(), self.inner(), size];
            multiply((of_group, self.inner(), true), outputs, images.transposed(), sides);
        }
        let biases = sums.sum_mut(2, self.weights.outputs);
        for (sum, of_output) in biases.iter_mut().zip(gradient.chunks_exact(area)) {
            *sum += of_output.iter().map(|g| f64::from(*g)).sum::<f64>() as f32;
        }
    }
}
