//! A camera from a video, or from the tags of a scene, against known cameras: the filmed walk of captures/walk, the photos of captures/board as a video, and
//! simulated views.

use std::path::{Path, PathBuf};
use std::process::Command;

use nalgebra::{Isometry3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::{Camera, CameraFormat};
use scaleproof_pose::scene::{Scene, Viewpoint};
use scaleproof_rig::calibrate::{
    BoardPhoto, Calibration, CalibrationError, Film, Motion, SeenCorner, Target, calibrate_film, look_at_video,
};
use scaleproof_testing::films::turn;

fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn walk(name: &str) -> PathBuf {
    home().join("captures/walk").join(name)
}

fn scene() -> Scene {
    Scene::open(&walk("scene.toml")).unwrap()
}

/// Focal length, principal point and k1.
fn numbers(camera: &Camera) -> [f64; 5] {
    [camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion()[0]]
}

fn assert_within_3_sigma(found: &Calibration, truth: &Camera) {
    for ((found, truth), sigma) in numbers(&found.camera).into_iter().zip(numbers(truth)).zip(found.sigmas) {
        assert!((found - truth).abs() < 3.0 * sigma, "{found} ± {sigma}, truly {truth}");
    }
}

/// A phone that was held the other way round: its container turns the film, and the camera is that of the film as it was.
#[test]
fn a_film_that_lies_otherwise_gives_the_same_camera() {
    let (folder, scene) = (tempfile::tempdir().unwrap(), scene());
    let [short, turned] = ["short.mp4", "turned.mp4"].map(|name| folder.path().join(name));
    let mut copied = Command::new("ffmpeg");
    copied.args(["-v", "error", "-i"]).arg(walk("normal.mp4"));
    copied.args(["-c", "copy", "-t", "2"]).arg(&short);
    assert!(copied.status().unwrap().success());
    turn(&short, 180, &turned);
    let [as_it_was, turned] =
        [short, turned].map(|film| look_at_video(&film, Target::Scene(&scene), |_, _| ()).unwrap());
    assert!(as_it_was.frames.len() > 10 && turned.frames.iter().all(|frame| frame.turned_deg == 180));
    let corners = |film: &Film| {
        film.frames
            .iter()
            .map(|frame| frame.corners.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(corners(&turned), corners(&as_it_was));
}

/// Every number is within 3 σ of the camera that the video was rendered with, although that has a rolling shutter of 10 ms, and the focal length within a thousandth; the file holds σ.
#[test]
fn the_tags_of_a_filmed_scene_give_the_camera() {
    let (truth, scene) = (Camera::open(&walk("camera.yaml")).unwrap(), scene());
    let film = look_at_video(&walk("normal.mp4"), Target::Scene(&scene), |_, _| ()).unwrap();
    assert_eq!((film.frames.len(), film.left_out.len()), (40, 1));
    let found = calibrate_film(film, Target::Scene(&scene)).unwrap();
    println!(
        "{:?} ± {:?}, rms {:.2}",
        numbers(&found.camera),
        found.sigmas,
        found.rms_px
    );
    assert_within_3_sigma(&found, &truth);
    assert!((found.camera.fx / truth.fx - 1.0).abs() < 0.001, "{}", found.camera.fx);
    assert!(found.sigmas[0] < 0.002 * found.camera.fx, "{}", found.sigmas[0]);
    assert!(
        found
            .camera
            .write(CameraFormat::OpenCv)
            .unwrap()
            .contains("standard deviations")
    );
}

/// A video without the board has no camera, and the sentence says what was looked at.
#[test]
fn a_video_without_the_board_is_refused() {
    let board = Definition::open(&home().join("calibration/charuco_9x7_22mm.toml")).unwrap();
    let film = look_at_video(&walk("normal.mp4"), Target::Board(&board), |_, _| ()).unwrap();
    let why = calibrate_film(film, Target::Board(&board)).unwrap_err().to_string();
    let start = "no photo shows the board; normal.mp4: none of the 120 frames looked at; the first: ";
    assert!(why.starts_with(start), "{why}");
}

/// The stored photos of a board, encoded as a video by ffmpeg, give the camera that they were rendered with.
#[test]
fn a_video_of_a_board_gives_the_camera() {
    let board = Definition::open(&home().join("calibration/charuco_9x7_22mm.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let video = folder.path().join("board.mp4");
    let made = Command::new("ffmpeg")
        .args(["-v", "error", "-framerate", "2", "-pattern_type", "glob", "-i"])
        .arg(home().join("captures/board/*.jpg"))
        .args(["-c:v", "libx264", "-crf", "12", "-pix_fmt", "yuv420p"])
        .arg(&video)
        .status()
        .unwrap();
    assert!(made.success());
    let film = look_at_video(&video, Target::Board(&board), |_, _| ()).unwrap();
    assert_eq!(film.frames.len(), 8);
    let found = calibrate_film(film, Target::Board(&board)).unwrap();
    println!(
        "{:?} ± {:?}, rms {:.2}",
        numbers(&found.camera),
        found.sigmas,
        found.rms_px
    );
    // As captures/board/truth.json has it.
    let truth = Camera::pinhole(1280, 960, 1180.0, 1180.0, 649.0, 474.0).with_distortion(&[-0.08, 0.03]);
    assert_within_3_sigma(&found, &truth);
}

// --- simulated views -----------------------------------------------------------------------------------------------------

const SIGMA_PX: f64 = 0.3;

fn normal(random: &mut Pcg64Mcg) -> f64 {
    (0..12).map(|_| random.random_range(-0.5..0.5)).sum()
}

/// How far the camera goes round in a second, degrees, and how long its rows are read, s.
const WALK_DEG_S: f64 = 30.0;
const READ_OUT_S: f64 = 0.02;

/// Where a camera at a viewpoint, which looks so far (mm) beside the model's middle, sees the tags that face it, whole; those that lie alone, where not `standing`.
fn seen(camera: &Camera, scene: &Scene, viewpoint: &Viewpoint, off: [f64; 3], standing: bool) -> Vec<SeenCorner> {
    let target = scene.model.target_mm();
    let centre = viewpoint.camera_centre_mm(target);
    // OpenCV's camera looks along +z with y down: nalgebra's look_at_lh, turned by half about z.
    let aim = target + Vector3::from(off);
    let upwards = if viewpoint.pitch_deg > 80.0 {
        Vector3::x()
    } else {
        Vector3::z()
    };
    let pose =
        Isometry3::rotation(Vector3::z() * std::f64::consts::PI) * Isometry3::look_at_lh(&centre, &aim, &upwards);
    let mut corners = Vec::new();
    for (place, tag) in scene.tags.iter().enumerate() {
        let faces = tag.normal().dot(&(centre - tag.centre_mm)) > 0.0;
        let is_meant = faces && (standing || tag.normal().z > 0.9);
        let is_inside = |[x, y]: &[f64; 2]| (0.0..1279.0).contains(x) && (0.0..719.0).contains(y);
        let px = tag
            .corners_px(&pose, camera)
            .filter(|px| is_meant && px.iter().all(is_inside));
        let corner = |(i, px)| SeenCorner { id: 4 * place + i, px };
        corners.extend(px.into_iter().flatten().enumerate().map(corner));
    }
    corners
}

/// What a camera sees from some viewpoints, with noise. `moving`: while it goes round, its rows read one after the other.
fn film(camera: &Camera, scene: &Scene, viewpoints: &[Viewpoint], (standing, moving): (bool, bool), seed: u64) -> Film {
    let random = &mut Pcg64Mcg::seed_from_u64(seed);
    let mut motion = Motion::new();
    let view = |(number, viewpoint): (usize, &Viewpoint)| {
        let file = format!("frame {number}");
        let off: [f64; 3] = std::array::from_fn(|_| random.random_range(-40.0..40.0));
        let later = Viewpoint {
            azimuth_deg: viewpoint.azimuth_deg + WALK_DEG_S / 30.0,
            ..*viewpoint
        };
        let later = seen(camera, scene, &later, off, standing);
        let mut corners = seen(camera, scene, viewpoint, off, standing);
        if moving {
            corners.retain_mut(|corner| {
                let Some(later) = later.iter().find(|later| later.id == corner.id) else {
                    return false;
                };
                let speed = [0, 1].map(|axis| 30.0 * (later.px[axis] - corner.px[axis]));
                let late_s = READ_OUT_S * ((corner.px[1] + 0.5) / 720.0 - 0.5);
                motion.insert((file.clone(), corner.id), speed);
                corner.px = [0, 1].map(|axis| corner.px[axis] + late_s * speed[axis]);
                true
            });
        }
        for corner in &mut corners {
            corner.px = corner.px.map(|v| v + SIGMA_PX * normal(random));
        }
        BoardPhoto {
            file,
            size: (1280, 720),
            turned_deg: 0,
            corners,
            edge_width_px: None,
        }
    };
    Film {
        frames: viewpoints.iter().enumerate().map(view).collect(),
        left_out: Vec::new(),
        motion,
    }
}

fn round(pitch_deg: f64, count: usize) -> Vec<Viewpoint> {
    let at = |i: usize| Viewpoint {
        azimuth_deg: 360.0 * i as f64 / count as f64,
        pitch_deg: pitch_deg + (i % 5) as f64 / 2.0,
        distance_mm: 850.0 + 20.0 * (i % 7) as f64,
    };
    (0..count).map(at).collect()
}

/// Of walks by several seeds, numbers are as far off as σ says: of 10 walks, at least nine focal lengths within 2 σ, all within 4.
#[test]
fn sigma_of_a_walk_is_what_it_says() {
    let (truth, scene) = (Camera::open(&walk("camera.yaml")).unwrap(), scene());
    let off = |seed| {
        let film = film(&truth, &scene, &round(14.0, 24), (true, false), seed);
        let found = calibrate_film(film, Target::Scene(&scene)).unwrap();
        (found.camera.fx - truth.fx).abs() / found.sigmas[0]
    };
    let off: Vec<f64> = (0..10).map(off).collect();
    assert!(
        off.iter().filter(|z| **z < 2.0).count() >= 9 && off.iter().all(|z| *z < 4.0),
        "{off:?}"
    );
}

/// Whoever walks round goes one way, and a rolling shutter of 20 ms leans every frame to one side (up to 3 px): the film tells how long the rows are read, so that the principal point is no
/// more than 1 px aside, and σ contains what is left.
#[test]
fn a_rolling_shutter_is_told_by_the_film_and_taken_back() {
    let (truth, scene) = (Camera::open(&walk("camera.yaml")).unwrap(), scene());
    for seed in 0..3 {
        let film = film(&truth, &scene, &round(14.0, 24), (true, true), seed);
        let found = calibrate_film(film, Target::Scene(&scene)).unwrap();
        assert_within_3_sigma(&found, &truth);
        assert!((found.camera.cx - truth.cx).abs() < 1.0, "{}", found.camera.cx);
        assert!(found.sigmas[2] < 1.0, "{}", found.sigmas[2]);
    }
}

/// Flat tags seen from straight above leave the focal length open, whatever the residuals: a camera further away with a longer lens sees the same.
#[test]
fn flat_tags_from_straight_above_are_refused() {
    let (truth, scene) = (Camera::open(&walk("camera.yaml")).unwrap(), scene());
    let above: Vec<Viewpoint> = round(87.0, 30)
        .into_iter()
        .map(|v| Viewpoint {
            distance_mm: v.distance_mm + 400.0,
            ..v
        })
        .collect();
    for seed in 0..3 {
        let why = calibrate_film(
            film(&truth, &scene, &above, (false, false), seed),
            Target::Scene(&scene),
        )
        .unwrap_err();
        assert!(matches!(why, CalibrationError::FocalOpen { .. }), "{why}");
        assert!(why.to_string().contains("film from the side"), "{why}");
    }
}
