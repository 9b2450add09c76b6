//! Check that the photos of a view show the colours that they are said to show.

use image::{GrayImage, RgbImage};

use crate::light;

/// Least difference of luminances of colours that must not look alike; below, surroundings and camera may decide.
const LEAST: f64 = 0.05;

/// Returns true unless a lighter colour looks darker than another one, or the same. Each image comes with its colour, 8-bit sRGB of the paint's reflectance;
/// all are of one view and exposure.
pub fn is_in_order(images: &[([u8; 3], &RgbImage)], paint: &GrayImage) -> bool {
    let shade = |(flat_rgb, image): &([u8; 3], &RgbImage)| (luminance(*flat_rgb), mean_luminance(image, paint));
    let mut shades: Vec<(f64, f64)> = images.iter().map(shade).collect();
    shades.sort_by(|a, b| a.0.total_cmp(&b.0));
    shades.iter().enumerate().all(|(i, darker)| {
        let mut lighter = shades[i..].iter().filter(|s| s.0 - darker.0 >= LEAST);
        lighter.all(|lighter| lighter.1 > darker.1)
    })
}

/// Luminance of 8-bit sRGB, 0 to 1.
fn luminance(rgb: [u8; 3]) -> f64 {
    light::luminance(light::linear_of(rgb))
}

/// Returns the mean luminance of the paint, weighted by how much of a pixel it covers.
fn mean_luminance(image: &RgbImage, paint: &GrayImage) -> f64 {
    let (mut sum, mut covered) = (0.0, 0.0);
    for (pixel, share) in image.pixels().zip(paint.pixels()) {
        let share = f64::from(share.0[0]);
        sum += share * luminance(pixel.0);
        covered += share;
    }
    sum / f64::max(covered, 1.0)
}
