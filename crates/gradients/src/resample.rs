//! An image into a network's input and its gradient back, as `detect` feeds the network for scoring, but without rounding to 8 bits.
//!
//! Resizing is linear in the image and separable; its adjoint uses the same weights.

use crate::separable::{Separable, Tap};
use scaleproof_detect::{Channels, Input, InputPlacement, Kernel, Layout};

/// The way of images of one size into one network.
pub(super) struct Resampler {
    input: Input,
    placement: InputPlacement,
    resized: Separable,
}

impl Resampler {
    pub(super) fn new(input: &Input, size_px: [u32; 2]) -> Resampler {
        let placement = InputPlacement::new(input, size_px[0], size_px[1]);
        let taps = |axis: usize| {
            let (from, to) = (size_px[axis] as usize, placement.size[axis] as usize);
            match input.kernel {
                Kernel::OpencvLinear => linear(from, to),
                Kernel::Antialiased => antialiased(from, to),
            }
        };
        Resampler {
            input: input.clone(),
            placement,
            resized: Separable::new(size_px.map(|side| side as usize), taps(0), taps(1)),
        }
    }

    pub(super) fn placement(&self) -> &InputPlacement {
        &self.placement
    }

    /// The input tensor's numbers of an image (sRGB, 0 to 1).
    pub(super) fn forward(&self, image: &[[f64; 3]]) -> Vec<f32> {
        let resized = self.resized.forward(image);
        let plane = self.plane();
        let mut tensor = vec![0.0; 3 * plane];
        for channel in 0..3 {
            let (mean, std) = self.normalisation(channel);
            let border = (f64::from(self.input.pad) - mean) / std;
            for at in 0..plane {
                tensor[self.index(channel, at)] = border as f32;
            }
            let source = self.source(channel);
            for (at, rgb) in self.inside().zip(&resized) {
                tensor[self.index(channel, at)] = ((255.0 * rgb[source] - mean) / std) as f32;
            }
        }
        tensor
    }

    /// From the derivative with respect to the tensor's numbers to that with respect to the image's.
    pub(super) fn backward(&self, gradient: &[f32]) -> Vec<[f64; 3]> {
        let [width, height] = self.resized_size();
        let mut resized = vec![[0.0; 3]; width * height];
        for channel in 0..3 {
            let (_, std) = self.normalisation(channel);
            let source = self.source(channel);
            for (at, rgb) in self.inside().zip(&mut resized) {
                rgb[source] = 255.0 / std * f64::from(gradient[self.index(channel, at)]);
            }
        }
        self.resized.transposed(&resized)
    }

    fn resized_size(&self) -> [usize; 2] {
        self.placement.size.map(|side| side as usize)
    }

    fn plane(&self) -> usize {
        self.placement.canvas.iter().map(|side| *side as usize).product()
    }

    /// The places of the resized image's pixels in a plane of the tensor.
    fn inside(&self) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.resized_size();
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

    /// Which of red, green, blue a channel of the tensor is.
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

/// A triangle as wide as an output pixel where the image is reduced, as PIL and `fast_image_resize` have it.
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use scaleproof_detect::{Resize, Values};

    fn input(kernel: Kernel, resize: Resize, layout: Layout) -> Input {
        Input {
            size_px: [64, 48],
            layout,
            values: Values::F32,
            resize,
            kernel,
            pad: 114,
            channels: Channels::Bgr,
            mean: [10.0, 20.0, 30.0],
            std: [50.0, 60.0, 70.0],
        }
    }

    /// ⟨A x, y⟩ = ⟨x, Aᵀ y⟩, with the border's constant taken off.
    #[test]
    fn the_way_back_is_the_transpose() {
        let mut rng = rand_pcg::Pcg32::seed_from_u64(3);
        for kernel in [Kernel::OpencvLinear, Kernel::Antialiased] {
            for resize in [
                Resize::Stretch,
                Resize::LetterboxTopLeft,
                Resize::LetterboxCentreRounded,
            ] {
                for (layout, size) in [
                    (Layout::Nchw, [97, 61]),
                    (Layout::Nhwc, [31, 40]),
                    (Layout::Nchw, [640, 33]),
                ] {
                    let way = Resampler::new(&input(kernel, resize, layout), size);
                    let pixels = (size[0] * size[1]) as usize;
                    let x: Vec<[f64; 3]> = (0..pixels).map(|_| std::array::from_fn(|_| rng.random())).collect();
                    let y: Vec<f32> = (0..3 * 64 * 48).map(|_| rng.random::<f32>() - 0.5).collect();
                    let black = way.forward(&vec![[0.0; 3]; pixels]);
                    let forth = way.forward(&x).into_iter().zip(black).zip(&y);
                    let forth: f64 = forth.map(|((a, b), y)| f64::from(a - b) * f64::from(*y)).sum();
                    let back = way.backward(&y);
                    let back: f64 = x
                        .iter()
                        .zip(&back)
                        .flat_map(|(x, b)| (0..3).map(move |c| x[c] * b[c]))
                        .sum();
                    assert!(
                        (forth - back).abs() < 1e-3,
                        "{kernel:?} {resize:?} {size:?}: {forth} {back}"
                    );
                }
            }
        }
    }

    /// `detect::input` rounds the resized image to 8 bits; apart from that it must be the same tensor.
    #[test]
    fn the_tensor_is_the_one_scoring_uses() {
        let photo = image::RgbImage::from_fn(301, 203, |x, y| {
            image::Rgb([(x * 5 % 256) as u8, (y * 7 % 256) as u8, ((x * y) % 256) as u8])
        });
        let image: Vec<[f64; 3]> = photo.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
        for kernel in [Kernel::OpencvLinear, Kernel::Antialiased] {
            for resize in [Resize::Stretch, Resize::LetterboxTopLeft, Resize::LetterboxCentre] {
                let input = input(kernel, resize, Layout::Nchw);
                let way = Resampler::new(&input, [301, 203]);
                let ours = way.forward(&image);
                let theirs = scaleproof_detect::tensor(&photo, &input, way.placement());
                let worst = ours
                    .iter()
                    .zip(&theirs)
                    .map(|(a, b)| (a - b).abs() * 50.0)
                    .fold(0.0, f32::max);
                assert!(worst < 1.2, "{kernel:?} {resize:?}: {worst} grey levels apart");
            }
        }
    }
}
