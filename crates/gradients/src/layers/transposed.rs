//! Transposed convolutions: what a convolution does back, forward.

use std::sync::Arc;

use super::convolution::Convolution;
use super::{Array, Back, Layer, Number, Sums, Weights, Windows};

pub struct Transposed<T = f32> {
    /// The convolution from the output to the input.
    convolution: Convolution<T>,
    biases: Weights<T>,
}

impl<T: Number> Transposed<T> {
    /// `windows`: as they lie on the output, one for each place of the input. `weights`: their outputs are the input's channels, their biases
    /// those of the output's.
    pub fn new(windows: Windows, mut weights: Weights<T>) -> Self {
        let biases = Weights {
            groups: 1,
            weights: Vec::new(),
            biases: weights.biases.take(),
            outputs: windows.channels,
        };
        Transposed {
            convolution: Convolution { windows, weights },
            biases,
        }
    }
}

impl<T: Number> Layer<T> for Transposed<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let w = &self.convolution.windows;
        let mut output = self.biases.biases_each(w.image_area());
        self.convolution.spread(&inputs[0], &mut output, false);
        let back = |gradient: Vec<T>, sums: &mut Sums<T>| {
            let sum = sums.sum_mut(0, self.convolution.weights.outputs * w.area());
            self.convolution.gather(&gradient, sum);
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
