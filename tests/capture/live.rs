//! A capture of a running camera at the stored session's scene.

use std::path::Path;

use scaleproof_capture::{Capture, Guidance, Judge, Store, Tolerance};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::TagDetectorChoice;

use crate::common::skyline;

/// Of the usual pitch at a distance.
pub fn live_capture(session: &Path, scene: &Scene, distance_mm: f64) -> Capture {
    let (scene_file, camera_file) = (skyline().join("scene.toml"), skyline().join("camera.yaml"));
    let tolerance = Tolerance::of_bins(&scene.bins, &[distance_mm]);
    let views = scene.bins.viewpoints(&[scene.bins.usual_view().0], &[distance_mm]);
    let guidance = Guidance::at(&views, tolerance, &scene.bins);
    let judge = Judge::new(scene, TagDetectorChoice::default(), true).unwrap();
    let store = Store::open(session, &scene_file, &camera_file, "normal").unwrap();
    Capture::new(
        guidance,
        judge,
        store,
        Camera::open(&camera_file).unwrap(),
        "normal",
        "yard",
    )
}
