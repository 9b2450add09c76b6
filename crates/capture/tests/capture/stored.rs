//! The stored session, and a capture of its views by a camera that runs.

use std::path::{Path, PathBuf};

use scaleproof_capture::{Capture, Guidance, Judge, Store, Tolerance};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::TagDetectorChoice;

pub fn skyline(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../captures/skyline")
        .join(name)
}

pub fn capture(session: &Path) -> Capture {
    let (scene_file, camera_file) = (skyline("scene.toml"), skyline("camera.yaml"));
    let scene = Scene::open(&scene_file).unwrap();
    let (pitch, distance) = scene.bins.usual_view();
    let tolerance = Tolerance::of_bins(&scene.bins, &[distance]);
    let guidance = Guidance::at(&scene.bins.viewpoints(&[pitch], &[distance]), tolerance, &scene.bins);
    let judge = Judge::new(&scene, TagDetectorChoice::default(), true).unwrap();
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
