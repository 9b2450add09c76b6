//! Images made smaller by the mean light of areas.

use image::{Rgb, RgbImage};
use palette::{LinSrgb, Srgb};

/// Returns columns × rows areas of an image, each as its mean in linear light. `middle` is the share of an area's width and height that counts: 1 is
/// all, and a pixel on the border of two areas counts for both by its parts in them.
pub fn averaged(image: &RgbImage, [columns, rows]: [u32; 2], middle: f64) -> RgbImage {
    let light: Vec<f64> = (0..=255_u8)
        .map(|level| Srgb::new(level, 0, 0).into_format::<f64>().into_linear::<f64>().red)
        .collect();
    let across = spans(image.width(), columns, middle);
    let down = spans(image.height(), rows, middle);
    RgbImage::from_fn(columns, rows, |column, row| {
        let (mut sum, mut area) = ([0.0; 3], 0.0);
        for (y, high) in &down[row as usize] {
            for (x, wide) in &across[column as usize] {
                let pixel = image.get_pixel(*x, *y).0;
                (0..3).for_each(|c| sum[c] += high * wide * light[usize::from(pixel[c])]);
                area += high * wide;
            }
        }
        let [r, g, b] = sum.map(|light| light / area);
        let mean: Srgb<f64> = Srgb::from_linear(LinSrgb::new(r, g, b));
        let mean: Srgb<u8> = mean.into_format();
        Rgb(mean.into())
    })
}

/// Returns for each of equal parts of a side its pixels and the part of each that is in it.
fn spans(pixels: u32, parts: u32, middle: f64) -> Vec<Vec<(u32, f64)>> {
    let size = f64::from(pixels) / f64::from(parts);
    let span = |part: u32| {
        let centre = (f64::from(part) + 0.5) * size;
        let (from, to) = (centre - 0.5 * middle * size, centre + 0.5 * middle * size);
        let last = (to.ceil() as u32).clamp(1, pixels);
        let share = |pixel: u32| f64::from(pixel + 1).min(to) - f64::from(pixel).max(from);
        let seen = (from.max(0.0) as u32..last).map(|pixel| (pixel, share(pixel)));
        // Rounding may leave a sliver.
        seen.filter(|(_, share)| *share > 1e-9).collect()
    };
    (0..parts).map(span).collect()
}
