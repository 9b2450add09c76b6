//! Test for a whole border. A covered or cut tag is still decoded, but with a corner several pixels off.
//!
//! That corner lies on whatever covers the tag. The test uses the half-cell rings just inside and just outside the found outline: on a whole tag one
//! is dark and the other light all the way round. A lamp or a bend of the paper lights a tag unevenly, but smoothly: each ring is compared with a
//! gradient fitted to it.

use image::GrayImage;
use nalgebra::{Matrix3, Vector3};

use super::TagHomography;
use scaleproof_core::statistics::upper_median;

/// Samples along each side of a ring, corners included.
const SAMPLES: usize = 16;

/// Maximum deviation of a ring's sample from the ring's gradient, as a share of the contrast.
///
/// Measured on the 159 tags seen in the skyline photos: the six whose worst corner is 2 px off or more all have two samples or more outside it, or
/// leave the image. Of 112 real tags (`swatbotics`, `veldrovive`), many with paper in half shadow, only one in motion blur of two cells has.
const TOLERANCE: f64 = 0.35;

/// Maximum number of a ring's samples that may deviate, as by a grain of dirt.
const MAX_OFF: usize = 1;

/// Returns true if both rings have one tone all the way round, up to a gradient of the light. `cells`: width of the outline in bit cells.
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
    // Families differ in which of the two is the dark one.
    let contrast = (light - dark).abs();
    let is_even = |ring: &[f64], depth| off_gradient(ring, depth, contrast) <= MAX_OFF;
    contrast > 0.0 && is_even(&inside, half_cell) && is_even(&outside, -half_cell)
}

/// Counts the samples of a ring that deviate from its gradient, fitted by least absolute differences (iteratively reweighted least squares,
/// Schlossmacher 1973), so that a cover over part of the ring does not tilt it.
fn off_gradient(ring: &[f64], depth: f64, contrast: f64) -> usize {
    let places: Vec<Vector3<f64>> = places(depth).map(|(u, v)| Vector3::new(1.0, u, v)).collect();
    let mut gradient = Vector3::new(upper_median(ring).unwrap_or(0.0), 0.0, 0.0);
    let off = |gradient: &Vector3<f64>, place: &Vector3<f64>, level: f64| (level - gradient.dot(place)).abs();
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (place, level) in places.iter().zip(ring) {
            let weight = 1.0 / off(&gradient, place, *level).max(LEAST_OFF * contrast);
            normal += weight * place * place.transpose();
            right += weight * *level * place;
        }
        match normal.cholesky() {
            Some(factor) => gradient = factor.solve(&right),
            None => break,
        }
    }
    let is_off = |(place, level): &(&Vector3<f64>, &f64)| off(&gradient, place, **level) > TOLERANCE * contrast;
    places.iter().zip(ring).filter(is_off).count()
}

/// Rounds of reweighting, and the residual, as a share of the contrast, below which weights are constant.
const ROUNDS: usize = 10;
const LEAST_OFF: f64 = 0.05;

/// Samples grey levels along a square ring, `depth` (share of the side) inside the outline; `None` if it leaves the image.
pub(super) fn ring(grey: &GrayImage, homography: &TagHomography, depth: f64) -> Option<Vec<f64>> {
    places(depth)
        .map(|(u, v)| level(grey, homography.pixel(u, v)))
        .collect()
}

/// Returns the sampling positions of a ring, in the outline's unit square.
fn places(depth: f64) -> impl Iterator<Item = (f64, f64)> {
    let (low, high) = (depth, 1.0 - depth);
    (0..SAMPLES).flat_map(move |i| {
        let along = low + (high - low) * i as f64 / (SAMPLES - 1) as f64;
        [(along, low), (along, high), (low, along), (high, along)]
    })
}

/// Returns the bilinearly interpolated grey level; `None` outside the image.
pub(super) fn level(grey: &GrayImage, [x, y]: [f64; 2]) -> Option<f64> {
    let (width, height) = grey.dimensions();
    let inside = x >= 0.0 && y >= 0.0 && x <= f64::from(width) - 1.0 && y <= f64::from(height) - 1.0;
    if !inside {
        return None;
    }
    // The function of the crate image takes four times as long, with the same result.
    let (x, y) = (x as f32, y as f32);
    let (left, above) = ((x as u32).min(width - 1), (y as u32).min(height - 1));
    let (right, below) = ((left + 1).min(width - 1), (above + 1).min(height - 1));
    let [to_right, down] = [x - left as f32, y - above as f32];
    let [to_left, up] = [(left + 1) as f32 - x, (above + 1) as f32 - y];
    let (pixels, stride) = (grey.as_raw(), width as usize);
    let at = |x: u32, y: u32| pixels.get(y as usize * stride + x as usize).copied().map(f32::from);
    let mixed = to_left * up * at(left, above)?
        + to_left * down * at(left, below)?
        + to_right * up * at(right, above)?
        + to_right * down * at(right, below)?;
    let whole = f32::from(mixed as u8);
    Some(f64::from(if mixed - whole >= 0.5 { whole + 1.0 } else { whole }))
}
