//! Corruptions that change each pixel by itself, or by its neighbours.

use image::{Rgb, RgbImage};
use rand::Rng;

use scaleproof_core::statistics::normal;

/// Adds normal noise of σ `sigma` (white is 1) to every channel.
pub(crate) fn noisy(image: &RgbImage, sigma: f64, rng: &mut impl Rng) -> RgbImage {
    let mut out = image.clone();
    for value in out.iter_mut() {
        *value = (f64::from(*value) + 255.0 * sigma * normal::draw(rng)).clamp(0.0, 255.0) as u8;
    }
    out
}

/// Adds `more` (white is 1) to the value of HSV; hue and saturation stay.
pub(crate) fn brighter(image: &RgbImage, more: f32) -> RgbImage {
    let mut out = image.clone();
    for pixel in out.pixels_mut() {
        let rgb = pixel.0.map(|v| f32::from(v) / 255.0);
        let value = rgb.into_iter().fold(0.0, f32::max);
        let new = (value + more).min(1.0);
        // Colours of one hue and saturation are multiples of each other. Black has neither, and becomes grey.
        let rgb = if value > 0.0 {
            rgb.map(|v| v * new / value)
        } else {
            [new; 3]
        };
        *pixel = Rgb(rgb.map(|v| (255.0 * v).clamp(0.0, 255.0) as u8));
    }
    out
}

/// Returns the mean over a disk of `radius` px whose edge a Gaussian of σ `soft_px` softens; the image is mirrored at its borders.
pub(crate) fn defocused(image: &RgbImage, (radius, soft_px): (i32, f32)) -> RgbImage {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let gaussian = gaussian(if radius <= 8 { 1 } else { 2 }, soft_px);
    let mut out = image.clone();
    for channel in 0..3 {
        let plane: Vec<f32> = image.pixels().map(|p| f32::from(p.0[channel])).collect();
        let soft = down(&across(&plane, width, &gaussian), width, height, &gaussian);
        let blurred = over_disk(&soft, (width, height), radius);
        for (pixel, value) in out.pixels_mut().zip(blurred) {
            pixel.0[channel] = value.clamp(0.0, 255.0) as u8;
        }
    }
    out
}

/// Returns the weights of a Gaussian at −reach to reach; their sum is 1.
fn gaussian(reach: i32, sigma: f32) -> Vec<f32> {
    let weights = (-reach..=reach).map(|x| (-0.5 * (x as f32 / sigma).powi(2)).exp());
    let weights: Vec<f32> = weights.collect();
    let sum: f32 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

fn across(plane: &[f32], width: usize, weights: &[f32]) -> Vec<f32> {
    plane.chunks(width).flat_map(|row| smoothed(row, weights)).collect()
}

fn down(plane: &[f32], width: usize, height: usize, weights: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; plane.len()];
    for x in 0..width {
        let column: Vec<f32> = (0..height).map(|y| plane[y * width + x]).collect();
        for (y, value) in smoothed(&column, weights).into_iter().enumerate() {
            out[y * width + x] = value;
        }
    }
    out
}

fn smoothed(line: &[f32], weights: &[f32]) -> Vec<f32> {
    let reach = (weights.len() / 2) as i64;
    let at = |i: usize, k: usize| line[mirrored(i as i64 + k as i64 - reach, line.len())];
    let sum = |i| weights.iter().enumerate().map(|(k, w)| w * at(i, k)).sum();
    (0..line.len()).map(sum).collect()
}

/// Returns the mean of all pixels at most `radius` px away.
fn over_disk(plane: &[f32], (width, height): (usize, usize), radius: i32) -> Vec<f32> {
    let half_widths: Vec<i64> = (-radius..=radius)
        .map(|dy| f64::from(radius * radius - dy * dy).sqrt().floor() as i64)
        .collect();
    let count: i64 = half_widths.iter().map(|half| 2 * half + 1).sum();
    let reach = i64::from(radius);
    // Sums from the left end of each row, which is prolonged by `reach` on both sides.
    let sums: Vec<Vec<f64>> = plane
        .chunks(width)
        .map(|row| {
            let mut sum = 0.0;
            let values = (-reach..width as i64 + reach).map(|x| {
                sum += f64::from(row[mirrored(x, width)]);
                sum
            });
            std::iter::once(0.0).chain(values).collect()
        })
        .collect();
    let mut out = Vec::with_capacity(plane.len());
    for y in 0..height as i64 {
        let rows: Vec<&[f64]> = (-reach..=reach)
            .map(|dy| sums[mirrored(y + dy, height)].as_slice())
            .collect();
        for x in 0..width as i64 {
            let total: f64 = rows
                .iter()
                .zip(&half_widths)
                .map(|(row, half)| row[(x + reach + half + 1) as usize] - row[(x + reach - half) as usize])
                .sum();
            out.push((total / count as f64) as f32);
        }
    }
    out
}

/// Reflects an index beyond an end at the end's middle: … 2 1 | 0 1 2 ….
fn mirrored(at: i64, count: usize) -> usize {
    let period = 2 * (count as i64 - 1).max(1);
    let at = at.rem_euclid(period);
    at.min(period - at).min(count as i64 - 1) as usize
}
