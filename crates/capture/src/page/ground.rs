//! Required views as a ring on the ground about the model, in a camera's image.

use nalgebra::Point3;

use super::dial::DialRings;
use super::state::from_corner;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bin, Scene};

/// Number of steps along each arc.
const STEPS: u8 = 8;

/// Returns the outline of each bin's sector, in the page's pixels; empty if a part of it is behind the camera. `pose` is
/// `T_camera_model`, `step_deg` the width of a bin.
pub(super) fn outlines_px(
    bins: &[Bin],
    step_deg: f64,
    rings: &DialRings,
    scene: &Scene,
    camera: &Camera,
    pose: &Rigid,
) -> Vec<Vec<[f64; 2]>> {
    let [length, width, _] = scene.model.size_mm;
    // As on the dial, with the model inside and a gap between sectors.
    let radius_mm = |share: f64| length.hypot(width) / 2.0 * (0.7 + 0.8 * share);
    let pixel = |azimuth_deg: f64, radius_mm: f64| {
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        camera.project(&(pose * Point3::new(radius_mm * cos, radius_mm * sin, 0.0)))
    };
    let outline = |bin: &Bin| {
        let ring = &rings.0[rings.ring_of(bin)];
        let azimuth_deg = |i: u8| bin.azimuth_deg + 0.94 * step_deg * (f64::from(i) / f64::from(STEPS) - 0.5);
        let inner = (0..=STEPS).map(|i| (azimuth_deg(i), ring.inner_share));
        let outer = (0..=STEPS).rev().map(|i| (azimuth_deg(i), ring.outer_share));
        let pixels = inner
            .chain(outer)
            .map(|(azimuth, share)| pixel(azimuth, radius_mm(share)).map(from_corner));
        pixels.collect::<Option<Vec<_>>>().unwrap_or_default()
    };
    bins.iter().map(outline).collect()
}
