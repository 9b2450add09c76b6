//! A camera from a video against the renderer's: the filmed walk of captures/walk, whose camera file is the one it was rendered with.

use std::path::{Path, PathBuf};

use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::{Camera, CameraFormat};
use scaleproof_pose::scene::Scene;
use scaleproof_rig::calibrate::{Target, calibrate_film, look_at_video};

fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn walk(name: &str) -> PathBuf {
    home().join("captures/walk").join(name)
}

/// Focal length, principal point and k1 within 3 σ of the camera they were rendered with, the focal length's σ below half a percent, and
/// the file holds σ.
#[test]
fn the_tags_of_a_filmed_scene_give_the_camera() {
    let truth = Camera::open(&walk("camera.yaml")).unwrap();
    let scene = Scene::open(&walk("scene.toml")).unwrap();
    {
        let video = "normal.mp4";
        let film = look_at_video(&walk(video), Target::Scene(&scene), |_, _| ()).unwrap();
        assert!(
            film.frames.len() == 40 && film.left_out.len() == 1,
            "{video}: {}",
            film.frames.len()
        );
        let found = calibrate_film(film, Target::Scene(&scene)).unwrap();
        let camera = &found.camera;
        let numbers = |camera: &Camera| [camera.fx, camera.fy, camera.cx, camera.cy, camera.distortion()[0]];
        println!(
            "{video}: {:?} ± {:?}, rms {:.2}, {:?}",
            numbers(camera),
            found.sigmas,
            found.rms_px,
            found.chosen_model().model
        );
        for ((found, truth), sigma) in numbers(camera).into_iter().zip(numbers(&truth)).zip(found.sigmas) {
            assert!(
                (found - truth).abs() < 3.0 * sigma,
                "{video}: {found} ± {sigma}, truly {truth}"
            );
        }
        assert!(found.sigmas[0] < 0.005 * camera.fx, "{video}: {}", found.sigmas[0]);
        assert!(
            camera
                .write(CameraFormat::OpenCv)
                .unwrap()
                .contains("standard deviations")
        );
    }
}

/// A video without the board has no camera, and the sentence says what was looked at.
#[test]
fn a_video_without_the_board_is_refused() {
    let board = Definition::open(&home().join("calibration/charuco_9x7_22mm.toml")).unwrap();
    let film = look_at_video(&walk("normal.mp4"), Target::Board(&board), |_, _| ()).unwrap();
    let why = calibrate_film(film, Target::Board(&board)).unwrap_err().to_string();
    assert!(
        why.starts_with("no photo shows the board; normal.mp4: none of the 120 frames looked at; the first: "),
        "{why}"
    );
}
