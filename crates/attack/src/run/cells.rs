//! Cells of a pattern as sRGB of 0 to 1.

use image::RgbImage;

use scaleproof_surface::pattern::Pattern;

/// Cell or pixel: sRGB, 0 to 1.
pub type Rgb = [f64; 3];

/// Converts 8-bit colours to sRGB of 0 to 1.
pub fn srgb(colours: &[[u8; 3]]) -> Vec<Rgb> {
    colours.iter().map(|rgb| rgb.map(|v| f64::from(v) / 255.0)).collect()
}

/// Returns the cells of a pattern.
pub fn of_pattern(pattern: &Pattern) -> Vec<Rgb> {
    of_image(pattern.cells())
}

/// Converts pixels to sRGB of 0 to 1, row by row.
pub fn of_image(image: &RgbImage) -> Vec<Rgb> {
    image.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect()
}

/// Converts cells or pixels to an image with `columns` columns.
pub fn to_image(cells: &[Rgb], columns: u32) -> RgbImage {
    RgbImage::from_fn(columns, cells.len() as u32 / columns, |x, y| {
        image::Rgb(cells[(y * columns + x) as usize].map(|v| (255.0 * v).round() as u8))
    })
}
