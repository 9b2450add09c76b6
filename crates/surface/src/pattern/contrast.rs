//! Contrast between the cells of a pattern.

use image::RgbImage;

use super::Pattern;
use super::colour::Lab;
use scaleproof_core::statistics::upper_median;

/// Returns the median ΔE2000 between neighbouring cells (right and below, across the pattern's repeat too).
pub fn median_delta_e(pattern: &Pattern) -> f64 {
    let cells: &RgbImage = pattern.cells();
    let (columns, rows) = cells.dimensions();
    let lab = |x: u32, y: u32| Lab::from_rgb(cells.get_pixel(x % columns, y % rows).0);
    let pairs = (0..rows).flat_map(|y| (0..columns).flat_map(move |x| [(x, y, x + 1, y), (x, y, x, y + 1)]));
    let differences: Vec<f64> = pairs
        .map(|(x, y, to_x, to_y)| lab(x, y).delta_e(lab(to_x, to_y)))
        .collect();
    // A pattern has at least one cell.
    upper_median(&differences).unwrap_or_default()
}
