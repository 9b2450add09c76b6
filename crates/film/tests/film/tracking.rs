//! Large frames are looked at reduced.

use std::path::{Path, PathBuf};
use std::process::Command;

use scaleproof_core::geometry::angle::turn;
use scaleproof_film::tracking::{FrameResult, FrameTracker, View};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_video::{Selection, Video};

/// The stored walk's frames are 1280 px long; so many times longer they are of 4K.
const TIMES: f64 = 3.0;

fn walk(name: &str) -> PathBuf {
    Path::new("../../captures/walk").join(name)
}

fn looks(film: &Path) -> Vec<FrameResult> {
    let (scene, camera) = (
        Scene::open(&walk("scene.toml")).unwrap(),
        Camera::open(&walk("camera.yaml")).unwrap(),
    );
    let mut tracker = FrameTracker::new(&scene, &camera, 0, TagDetectorChoice::default()).unwrap();
    let selection = Selection {
        to_s: Some(2.45),
        ..Selection::default()
    };
    let frames = Video::open(film).unwrap().pictures(&selection).unwrap();
    frames.map(|frame| tracker.track(frame.unwrap())).collect()
}

/// The same poses, and what is said in pixels is in pixels of the film: from a camera file for smaller frames, too.
#[test]
fn frames_of_4k_show_what_the_film_they_were_enlarged_from_shows() {
    let folder = tempfile::tempdir().unwrap();
    let enlarged = folder.path().join("enlarged.mp4");
    let done = Command::new("ffmpeg")
        .args(["-v", "error", "-t", "2.5", "-i"])
        .arg(walk("normal.mp4"))
        .args([
            "-vf",
            "scale=3840:2160:flags=bicubic",
            "-c:v",
            "libx264",
            "-preset",
            "ultrafast",
            "-crf",
            "12",
        ])
        .arg(&enlarged)
        .status();
    assert!(done.unwrap().success());
    let (small, large) = (looks(&walk("normal.mp4")), looks(&enlarged));
    assert_eq!((small.len(), large.len()), (30, 30));
    let pairs: Vec<(View, View)> = (small.iter().zip(&large))
        .map(|(one, other)| (one.shows.unwrap(), other.shows.unwrap()))
        .collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let off = |(one, other): &(View, View)| turn(one.viewpoint.azimuth_deg, other.viewpoint.azimuth_deg).abs();
    let off: Vec<f64> = pairs.iter().map(off).collect();
    // Encoded again, what moves fast is somewhere else by a tenth of a pixel.
    let worst = off.iter().copied().fold(0.0, f64::max);
    let usual = median(off);
    println!("azimuths {usual:.3}° apart, {worst:.3}° at most");
    assert!(usual < 0.03 && worst < 0.3, "{usual}°, {worst}°");
    let ratios = pairs
        .iter()
        .map(|(one, other)| other.blur_px.unwrap() / one.blur_px.unwrap());
    let ratio = median(ratios.collect());
    println!("blur: {ratio:.2} times as many px");
    assert!((0.8 * TIMES..1.25 * TIMES).contains(&ratio), "{ratio}");
}
