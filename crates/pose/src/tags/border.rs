//! Is a tag's border whole? A covered or cut tag is still decoded, but with a corner several pixels off.
//!
//! Each corner then lies on whatever covers the tag. The half-cell rings just inside and just outside the found outline tell:
//! on a whole tag one is dark and the other light all the way round.

use image::GrayImage;

use super::TagHomography;
use scaleproof_core::statistics::upper_median;

/// Samples along each side of a ring, corners included.
const SAMPLES: usize = 16;

/// A sample belongs to its ring when it is within this share of the contrast of the ring's median.
///
/// Measured on the 159 tags seen in the skyline photos: the six whose worst corner is 2 px off or more all have three samples
/// or more outside it, or leave the image; so do four of the 153 others.
const TOLERANCE: f64 = 0.35;

/// So many of a ring's samples may be off: a grain of dirt.
const MAX_OFF: usize = 1;

/// True when both rings are of one tone all the way round. `cells`: width of the outline in bit cells.
pub fn is_whole(grey: &GrayImage, corners_px: &[[f64; 2]; 4], cells: f64) -> bool {
    let homography = TagHomography::to(corners_px);
    let half_cell = 0.5 / cells;
    let levels = |depth| {
        let ring = ring(grey, &homography, depth)?;
        Some((upper_median(&ring)?, ring))
    };
    let (Some((dark, inside)), Some((light, outside))) = (levels(half_cell), levels(-half_cell)) else {
        return false;
    };
    // Families differ in which of the two is the dark one, and light falls off across a tag; both are fine.
    let contrast = (light - dark).abs();
    let off = |ring: &[f64], own: f64| ring.iter().filter(|v| (**v - own).abs() > TOLERANCE * contrast).count();
    contrast > 0.0 && off(&inside, dark) <= MAX_OFF && off(&outside, light) <= MAX_OFF
}

/// Grey levels along a square ring, `depth` (share of the side) inside the outline; `None` when it leaves the image.
pub(super) fn ring(grey: &GrayImage, homography: &TagHomography, depth: f64) -> Option<Vec<f64>> {
    let (low, high) = (depth, 1.0 - depth);
    let mut levels = Vec::with_capacity(4 * SAMPLES);
    for i in 0..SAMPLES {
        let along = low + (high - low) * i as f64 / (SAMPLES - 1) as f64;
        for (u, v) in [(along, low), (along, high), (low, along), (high, along)] {
            levels.push(level(grey, homography.pixel(u, v))?);
        }
    }
    Some(levels)
}

/// Bilinear grey level; `None` outside the image.
pub(super) fn level(grey: &GrayImage, [x, y]: [f64; 2]) -> Option<f64> {
    let inside = x >= 0.0 && y >= 0.0 && x <= f64::from(grey.width()) - 1.0 && y <= f64::from(grey.height()) - 1.0;
    if !inside {
        return None;
    }
    image::imageops::interpolate_bilinear(grey, x as f32, y as f32).map(|p| f64::from(p.0[0]))
}
