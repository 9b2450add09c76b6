//! `cargo bench`: how much faster the default tag detector is than C AprilTag at full size, from grey picture to pose.
//!
//! The stored session enlarged three times (3840×2880 px), one thread; the median over its photos of the best of two runs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use image::GrayImage;
use image::imageops::{self, FilterType};
use scaleproof::{Camera, CornersBy, Photo, Scene, TagDetector, TagDetectorChoice, locate};

const ENLARGED: u32 = 3;
const RUNS: usize = 2;

/// A photo and the exact azimuth (°), pitch (°) and distance (mm) it was taken from.
struct View {
    grey: GrayImage,
    truth: [f64; 3],
}

/// One detector on all photos.
struct Measured {
    ms: f64,
    answered: usize,
    /// Worst error in azimuth (°), pitch (°), distance (mm).
    worst: [f64; 3],
}

fn main() {
    let scene = Scene::open(&session("scene.toml")).expect("the stored scene");
    let camera = enlarged_camera(&Camera::open(&session("camera.yaml")).expect("the stored camera"));
    let views = views();
    println!(
        "{:<16} {:>8} {:>9} {:>9} {:>9} {:>9}",
        "detector", "ms", "answered", "azimuth", "pitch", "distance"
    );
    let mut measured = Vec::new();
    for choice in [
        TagDetectorChoice::AprilTagC(CornersBy::Library),
        TagDetectorChoice::default(),
    ] {
        let mut tags = choice.open(&scene.families()).expect("both read every family");
        let m = measure(tags.as_mut(), &views, &scene, &camera);
        let [azimuth, pitch, distance] = m.worst;
        println!(
            "{:<16} {:>8.1} {:>6}/{} {azimuth:>8.4}° {pitch:>8.4}° {distance:>6.3} mm",
            choice.name(),
            m.ms,
            m.answered,
            views.len()
        );
        measured.push(m);
    }
    let [full_size, default] = &measured[..] else { return };
    println!("ratio {:.1}", full_size.ms / default.ms);
    assert!(
        default.answered >= full_size.answered,
        "the default answers fewer photos"
    );
    assert!(
        full_size.ms >= 3.0 * default.ms,
        "the default is less than three times as fast"
    );
}

fn measure(tags: &mut dyn TagDetector, views: &[View], scene: &Scene, camera: &Camera) -> Measured {
    let (mut times, mut answered, mut worst) = (Vec::new(), 0, [0.0_f64; 3]);
    for view in views {
        let mut best_ms = f64::INFINITY;
        for run in 0..RUNS {
            let start = Instant::now();
            let located = locate(&tags.find(&view.grey), scene, camera);
            best_ms = best_ms.min(start.elapsed().as_secs_f64() * 1000.0);
            if let (0, Ok(located)) = (run, located) {
                answered += 1;
                let (v, [azimuth, pitch, distance]) = (located.viewpoint, view.truth);
                let errors = [
                    turn(v.azimuth_deg, azimuth),
                    v.pitch_deg - pitch,
                    v.distance_mm - distance,
                ];
                worst = std::array::from_fn(|i| worst[i].max(errors[i].abs()));
            }
        }
        times.push(best_ms);
    }
    times.sort_by(f64::total_cmp);
    Measured {
        ms: times[times.len() / 2],
        answered,
        worst,
    }
}

/// From one direction to another, −180 to 180°.
fn turn(from: f64, to: f64) -> f64 {
    (to - from + 540.0).rem_euclid(360.0) - 180.0
}

fn session(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("captures/skyline")
        .join(file)
}

/// The plain and random ones.
fn views() -> Vec<View> {
    let text = std::fs::read_to_string(session("truth.json")).expect("the stored truth");
    let truth: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let photos = truth["photos"].as_array().expect("a list of photos").iter();
    let named = photos.map(|photo| (photo, photo["file"].as_str().expect("a name")));
    named
        .filter(|(_, file)| file.starts_with("normal_") || file.starts_with("random_"))
        .map(|(photo, file)| {
            let grey = Photo::open(&session(file))
                .expect("a photo")
                .luma()
                .expect("a whole photo");
            let (width, height) = (ENLARGED * grey.width(), ENLARGED * grey.height());
            View {
                grey: imageops::resize(&grey, width, height, FilterType::CatmullRom),
                truth: ["azimuth_deg", "pitch_deg", "distance_mm"].map(|key| photo[key].as_f64().expect("a number")),
            }
        })
        .collect()
}

/// The camera of the enlarged photos.
fn enlarged_camera(c: &Camera) -> Camera {
    c.scaled_to(c.width * ENLARGED, c.height * ENLARGED)
        .expect("the same aspect ratio")
}
