//! Fog: light and dark clouds over the image (a plasma fractal, made by diamonds and squares).

use image::{Rgb, RgbImage};
use rand::{Rng, RngExt};

/// Returns the image under an amount of fog; with each halving of the distance between points their randomness is divided by `decay`.
///
/// x ← (x + amount · plasma) · m / (m + amount), where m is the brightest channel of the image and x is of 1.
pub(crate) fn foggy(image: &RgbImage, (amount, decay): (f32, f64), rng: &mut impl Rng) -> RgbImage {
    let side = image.width().max(image.height()).next_power_of_two().max(2) as usize;
    let plasma = plasma(side, decay, rng);
    let brightest = f32::from(image.iter().copied().max().unwrap_or(0)) / 255.0;
    let mut out = image.clone();
    for (x, y, pixel) in out.enumerate_pixels_mut() {
        let fog = amount * plasma[y as usize * side + x as usize];
        let foggy = |v: u8| (f32::from(v) / 255.0 + fog) * brightest / (brightest + amount);
        *pixel = Rgb(pixel.0.map(|v| (255.0 * foggy(v)).clamp(0.0, 255.0) as u8));
    }
    out
}

/// Returns heights from 0 to 1 on a periodic grid of `side` (a power of two) by `side`.
fn plasma(side: usize, decay: f64, rng: &mut impl Rng) -> Vec<f32> {
    let mut heights = vec![0.0; side * side];
    let at = |x: usize, y: usize| (y % side) * side + x % side;
    let (mut step, mut wobble) = (side, 100.0);
    while step >= 2 {
        let half = step / 2;
        let mut mean = |heights: &mut [f64], [x, y]: [usize; 2], around: [[usize; 2]; 4]| {
            let sum: f64 = around.iter().map(|[x, y]| heights[at(*x, *y)]).sum();
            heights[at(x, y)] = 0.25 * sum + wobble * rng.random_range(-wobble..wobble);
        };
        // The middles of the squares, then those of the diamonds between them.
        for (x, y) in corners(side, step) {
            let square = [[x, y], [x + step, y], [x, y + step], [x + step, y + step]];
            mean(&mut heights, [x + half, y + half], square);
        }
        for (x, y) in corners(side, step) {
            let above = [[x, y], [x + step, y], [x + half, y + half], [x + half, y + side - half]];
            mean(&mut heights, [x + half, y], above);
            let left = [[x, y], [x, y + step], [x + half, y + half], [x + side - half, y + half]];
            mean(&mut heights, [x, y + half], left);
        }
        step = half;
        wobble /= decay;
    }
    let (low, high) = heights
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (low.min(*h), high.max(*h))
        });
    heights.iter().map(|h| ((h - low) / (high - low)) as f32).collect()
}

fn corners(side: usize, step: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..side / step).flat_map(move |j| (0..side / step).map(move |i| (i * step, j * step)))
}
