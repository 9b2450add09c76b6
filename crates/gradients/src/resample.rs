//! An image into a network's input and its gradient back, as `detect` feeds the network for scoring, but without rounding to 8 bits or an end at black and white.
//!
//! Resizing is linear in the image and separable; its adjoint uses the same weights.

use crate::separable::{Separable, Tap};
use scaleproof_detect::{Channels, Input, InputPlacement, Kernel, Layout};
use scaleproof_photo::{CubicTap, cubic_taps};

/// Images of one size as the input tensor of one network, and derivatives back.
pub struct Resampler {
    input: Input,
    placement: InputPlacement,
    resized: Separable,
}

impl Resampler {
    /// For images of `size_px`, width and height.
    pub fn new(input: &Input, size_px: [u32; 2]) -> Resampler {
        let placement = InputPlacement::new(input, size_px[0], size_px[1]);
        let [columns, rows] = [0, 1].map(|axis| {
            let (from, to) = (size_px[axis] as usize, placement.size[axis] as usize);
            match input.kernel {
                Kernel::OpencvLinear => linear(from, to),
                Kernel::OpencvCubic => cubic(from, to),
                Kernel::Antialiased => antialiased(from, to),
            }
        });
        Resampler {
            input: input.clone(),
            placement,
            resized: Separable::new(size_px.map(|side| side as usize), columns, rows),
        }
    }

    /// Returns where the resized image lies in the input.
    pub fn placement(&self) -> &InputPlacement {
        &self.placement
    }

    /// The input tensor's numbers of an image (sRGB, 0 to 1).
    pub fn forward(&self, image: &[[f64; 3]]) -> Vec<f32> {
        let resized = self.resized.forward(image);
        let plane = self.plane();
        let mut tensor = vec![0.0; 3 * plane];
        for channel in 0..3 {
            let (mean, std) = self.normalisation(channel);
            let border = (f64::from(self.input.pad.level(channel)) - mean) / std;
            (0..plane).for_each(|at| tensor[self.index(channel, at)] = border as f32);
            let source = self.source(channel);
            for (at, rgb) in self.inside().zip(&resized) {
                tensor[self.index(channel, at)] = ((255.0 * rgb[source] - mean) / std) as f32;
            }
        }
        tensor
    }

    /// Returns the derivative by the image's numbers from that by the tensor's (the adjoint).
    pub fn backward(&self, gradient: &[f32]) -> Vec<[f64; 3]> {
        let mut resized = vec![[0.0; 3]; self.inside().count()];
        for channel in 0..3 {
            let (_, std) = self.normalisation(channel);
            let source = self.source(channel);
            for (at, rgb) in self.inside().zip(&mut resized) {
                rgb[source] = 255.0 / std * f64::from(gradient[self.index(channel, at)]);
            }
        }
        self.resized.transposed(&resized)
    }

    fn plane(&self) -> usize {
        self.placement.canvas.iter().map(|side| *side as usize).product()
    }

    /// The places of the resized image's pixels in a plane of the tensor.
    fn inside(&self) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.placement.size.map(|side| side as usize);
        let [left, top] = self.placement.offset.map(|v| v as usize);
        let canvas = self.placement.canvas[0] as usize;
        (0..height).flat_map(move |y| (0..width).map(move |x| (top + y) * canvas + left + x))
    }

    fn index(&self, channel: usize, at: usize) -> usize {
        match self.input.layout {
            Layout::Nchw | Layout::Chw => channel * self.plane() + at,
            Layout::Nhwc => 3 * at + channel,
        }
    }

    fn normalisation(&self, channel: usize) -> (f64, f64) {
        (f64::from(self.input.mean[channel]), f64::from(self.input.std[channel]))
    }

    /// Returns which of red, green, blue a channel of the tensor is.
    fn source(&self, channel: usize) -> usize {
        match self.input.channels {
            Channels::Rgb => channel,
            Channels::Bgr => 2 - channel,
        }
    }
}

/// OpenCV's `INTER_LINEAR`: the two pixels around the place, the border's pixel beyond the border.
fn linear(from: usize, to: usize) -> Vec<Tap> {
    let scale = from as f64 / to as f64;
    let tap = |at: usize| {
        let place = ((at as f64 + 0.5) * scale - 0.5).clamp(0.0, from as f64 - 1.0);
        let first = (place as usize).min(from.saturating_sub(2));
        let share = place - first as f64;
        let weights = if from == 1 { vec![1.0] } else { vec![1.0 - share, share] };
        Tap { first, weights }
    };
    (0..to).map(tap).collect()
}

/// OpenCV's `INTER_CUBIC`: what lies beyond the border counts for the border's pixel.
fn cubic(from: usize, to: usize) -> Vec<Tap> {
    let tap = |CubicTap { places, weights }: CubicTap| {
        let first = places[0];
        let mut counted = vec![0.0; places[3] + 1 - first];
        places
            .iter()
            .zip(weights)
            .for_each(|(place, weight)| counted[place - first] += weight);
        Tap {
            first,
            weights: counted,
        }
    };
    cubic_taps(from, to).into_iter().map(tap).collect()
}

/// A triangle as wide as an output pixel where the image is reduced, as Pillow has it.
fn antialiased(from: usize, to: usize) -> Vec<Tap> {
    let scale = from as f64 / to as f64;
    let support = scale.max(1.0);
    let tap = |at: usize| {
        let centre = (at as f64 + 0.5) * scale;
        let first = (centre - support).floor().max(0.0) as usize;
        let end = ((centre + support).ceil() as usize).min(from);
        let weight = |i: usize| (1.0 - ((i as f64 + 0.5 - centre) / support).abs()).max(0.0);
        let weights: Vec<f64> = (first..end).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        let weights = weights.iter().map(|w| w / sum).collect();
        Tap { first, weights }
    };
    (0..to).map(tap).collect()
}
