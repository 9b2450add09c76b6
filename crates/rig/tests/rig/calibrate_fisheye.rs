//! A fisheye, calibrated from corners simulated with noise; the truth is known.

use std::path::Path;

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::{Camera, DistortionModel};
use scaleproof_rig::calibrate::{BoardPhoto, Calibration, LensModel, SeenCorner, View, answer, calibrate, refit};

const SIZE: (u32, u32) = (1280, 960);
const SIGMA_PX: f64 = 0.15;

fn board() -> Definition {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration/charuco_9x7_22mm.toml");
    Definition::open(&file).unwrap()
}

/// 170° across.
fn fisheye() -> Camera {
    Camera::pinhole(SIZE.0, SIZE.1, 430.0, 432.0, 652.0, 470.0).with_fisheye([0.03, -0.01, 0.003, -0.001])
}

/// Numbers of a seed in [0, 1) (Knuth's MMIX generator).
struct Random(u64);

impl Random {
    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Nearly normal, standard deviation 1: a sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform(-0.5, 0.5)).sum()
    }
}

/// `T_camera_board` of a board whose middle is seen up to so far off the axis, and which is tilted by up to 40° to that ray.
fn pose(off_axis_deg: f64, distance_mm: [f64; 2], random: &mut Random) -> Isometry3<f64> {
    let about = |axis: Vector3<f64>, deg: f64| UnitQuaternion::new(axis * deg.to_radians());
    let mut any = |most: f64| random.uniform(-most, most);
    let tilt = about(Vector3::x(), any(40.0)) * about(Vector3::y(), any(40.0)) * about(Vector3::z(), any(30.0));
    let ray = about(Vector3::z(), any(180.0)) * about(Vector3::y(), any(off_axis_deg));
    let away = Translation3::new(0.0, 0.0, random.uniform(distance_mm[0], distance_mm[1]));
    ray * away * tilt * Translation3::new(-99.0, -77.0, 0.0)
}

fn photo(number: usize, camera: &Camera, pose: &Isometry3<f64>, random: &mut Random) -> BoardPhoto {
    let mut corners = Vec::new();
    for (id, [x, y]) in board().corners_mm().into_iter().enumerate() {
        if let Some([u, v]) = camera.project(&(pose * Point3::new(x, y, 0.0))) {
            let px = [u + SIGMA_PX * random.normal(), v + SIGMA_PX * random.normal()];
            if (0.0..1279.0).contains(&px[0]) && (0.0..959.0).contains(&px[1]) {
                corners.push(SeenCorner { id, px });
            }
        }
    }
    BoardPhoto {
        file: format!("{number:02}.jpg"),
        size: SIZE,
        turned_deg: 0,
        corners,
        edge_width_px: None,
    }
}

fn photos(camera: &Camera, off_axis_deg: f64, distance_mm: [f64; 2], seed: u64) -> Vec<BoardPhoto> {
    let random = &mut Random(seed);
    let all = (0..16).map(|i| {
        let pose = pose(off_axis_deg, distance_mm, random);
        photo(i, camera, &pose, random)
    });
    all.filter(|photo| photo.corners.len() >= 20).collect()
}

fn found(photos: Vec<BoardPhoto>) -> Calibration {
    calibrate(photos, Vec::new(), &board()).unwrap()
}

#[test]
fn a_fisheye_is_chosen_and_its_numbers_are_right_within_what_is_stated() {
    let truth = fisheye();
    for seed in 0..4 {
        let mut photos = photos(&truth, 55.0, [130.0, 250.0], seed);
        let wrong = &mut photos[3].corners[10].px;
        *wrong = [wrong[0] + 6.0, wrong[1] - 5.0];
        let count = photos.len();
        let found = found(photos);
        for model in &found.models {
            println!("{}: held-out {:.3} px", model.model.name(), model.held_out_px);
        }
        let pairs = found
            .camera
            .parameters()
            .values
            .into_iter()
            .zip(truth.parameters().values);
        let z: Vec<f64> = pairs
            .zip(found.sigmas)
            .take(8)
            .map(|((a, b), sigma)| (a - b) / sigma)
            .collect();
        println!(
            "seed {seed}, {count} photos: f {:.2} ± {:.2}, errors by σ {z:.1?}",
            found.camera.fx, found.sigmas[0]
        );
        assert_eq!(found.chosen_model().model, LensModel::Fisheye);
        assert_eq!(found.camera.distortion_model(), DistortionModel::Fisheye);
        assert!(
            z.iter().all(|z| z.abs() < 3.5) && z[0].abs() < 3.0 && z[1].abs() < 3.0,
            "{z:?}"
        );
        assert!(found.sigmas[0] < 1.0 && found.chosen_model().held_out_px < 2.0 * SIGMA_PX);
        assert_eq!(
            (found.photos.len(), found.lost_corners),
            (count, 1),
            "only the wrong corner is left out"
        );
        let told = serde_json::to_value(answer(&found)).unwrap();
        assert!(
            told["distortion"].is_null() && told["fisheye"].as_array().unwrap().len() == 4,
            "{told}"
        );
        assert_eq!(told["distortion_sigma"].as_array().unwrap().len(), 4);
    }
}

#[test]
fn a_usual_lens_is_no_fisheye() {
    let pinhole = Camera::pinhole(SIZE.0, SIZE.1, 900.0, 900.0, 652.0, 470.0);
    for (camera, model) in [
        (pinhole.clone().with_distortion(&[-0.12]), LensModel::K1),
        (pinhole.clone().with_distortion(&[-0.25, 0.12]), LensModel::K1K2),
        (
            pinhole.with_distortion(&[-0.1, 0.03, 0.002, -0.002, 0.01]),
            LensModel::PlumbBob,
        ),
    ] {
        for seed in 10..12 {
            let found = found(photos(&camera, 15.0, [250.0, 400.0], seed));
            let held_out = |model: LensModel| found.models.iter().find(|m| m.model == model).map(|m| m.held_out_px);
            println!(
                "{model:?}: held-out {:?}, fisheye {:?}",
                held_out(model),
                held_out(LensModel::Fisheye)
            );
            assert_eq!(found.chosen_model().model, model);
        }
    }
}

/// `advise` refits few numbers of a camera; the lens keeps its formula and the coefficients that are not fitted.
#[test]
fn a_refitted_fisheye_stays_one() {
    let (truth, random) = (fisheye(), &mut Random(7));
    let poses: Vec<_> = (0..10).map(|_| pose(40.0, [150.0, 250.0], random)).collect();
    let places = board().corners_mm();
    let views = poses.iter().enumerate().map(|(i, pose)| {
        let photo = photo(i, &truth, pose, random);
        View {
            points_mm: photo
                .corners
                .iter()
                .map(|c| Point3::new(places[c.id][0], places[c.id][1], 0.0))
                .collect(),
            seen_px: photo.corners.iter().map(|c| c.px).collect(),
        }
    });
    let views: Vec<View> = views.collect();
    let mut square = truth.clone();
    (square.fx, square.fy) = (440.0, 440.0);
    let found = refit(LensModel::K1, &square, &views, poses).unwrap();
    assert!(found.is_fisheye() && found.distortion()[1..] == truth.distortion()[1..]);
    assert!(
        (429.5..432.5).contains(&found.fx) && (found.distortion()[0] - 0.03).abs() < 0.005,
        "{found:?}"
    );
}
