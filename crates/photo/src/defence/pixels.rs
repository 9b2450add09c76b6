//! Defences that change each value by itself, or using its neighbours.

use image::{Rgb, RgbImage};

/// Rounds each value to the nearest of 2ⁿ levels from 0 to 255.
pub(super) fn rounded(picture: &RgbImage, bits: u8) -> RgbImage {
    let steps = f64::from((1u32 << bits) - 1);
    let level = |v: usize| (255.0 * (v as f64 * steps / 255.0).round() / steps).round() as u8;
    let levels: [u8; 256] = std::array::from_fn(level);
    let mut out = picture.clone();
    out.iter_mut().for_each(|v| *v = levels[usize::from(*v)]);
    out
}

/// Computes the median of each channel over squares of `side` px: of an even number of values the upper of the two in the middle, and of an even side
/// one pixel more at the left and the top. Beyond the border the picture is mirrored, as by `scipy.ndimage.median_filter`, which Xu et al. use.
pub(super) fn median(picture: &RgbImage, side: u8) -> RgbImage {
    let (width, height) = picture.dimensions();
    let (side, before) = (i64::from(side), i64::from(side / 2));
    let around = |at: u32, count: u32| (0..side).map(move |k| mirrored(i64::from(at) + k - before, count));
    let mut square: [Vec<u8>; 3] = Default::default();
    RgbImage::from_fn(width, height, |x, y| {
        square.iter_mut().for_each(Vec::clear);
        for row in around(y, height) {
            for column in around(x, width) {
                let pixel = picture.get_pixel(column, row);
                square.iter_mut().zip(pixel.0).for_each(|(values, v)| values.push(v));
            }
        }
        Rgb(std::array::from_fn(|channel| {
            let values = &mut square[channel];
            let middle = values.len() / 2;
            *values.select_nth_unstable(middle).1
        }))
    })
}

/// Reflects an index beyond an end at the border: … 1 0 | 0 1 2 ….
fn mirrored(at: i64, count: u32) -> u32 {
    let count = i64::from(count);
    let at = at.rem_euclid(2 * count);
    at.min(2 * count - 1 - at) as u32
}
