//! Images as the tensors that scoring uses, and derivatives back.

use rand::{RngExt, SeedableRng};
use scaleproof_detect::{Channels, Input, Kernel, Layout, Pad, Resize, Values};
use scaleproof_gradients::resample::Resampler;

fn input(kernel: Kernel, resize: Resize, layout: Layout) -> Input {
    Input {
        size_px: [64, 48],
        layout,
        values: Values::F32,
        resize,
        kernel,
        pad: Pad::Grey(114),
        channels: Channels::Bgr,
        mean: [10.0, 20.0, 30.0],
        std: [50.0, 60.0, 70.0],
    }
}

/// ⟨A x, y⟩ = ⟨x, Aᵀ y⟩, with the border's constant taken off.
#[test]
fn the_way_back_is_the_transpose() {
    let mut rng = rand_pcg::Pcg32::seed_from_u64(3);
    for kernel in [Kernel::OpencvLinear, Kernel::OpencvCubic, Kernel::Antialiased] {
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

/// `detect::input` rounds the resized image to 8 bits and ends where cubic resizing goes beyond black and white, which these greys do not reach; apart
/// from that it must be the same tensor.
#[test]
fn the_tensor_is_the_one_scoring_uses() {
    let photo = image::RgbImage::from_fn(301, 203, |x, y| {
        image::Rgb([x * 5, y * 7, x * y].map(|v| 64 + (v % 128) as u8))
    });
    let image: Vec<[f64; 3]> = photo.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect();
    for kernel in [Kernel::OpencvLinear, Kernel::OpencvCubic, Kernel::Antialiased] {
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
