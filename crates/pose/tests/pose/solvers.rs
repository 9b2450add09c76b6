//! Projection and the direct pose solvers against OpenCV's on random views.

use std::cell::Cell;

use nalgebra::{Point3, Rotation3, Vector3};
use opencv::calib3d::{self, SolvePnPMethod};
use opencv::core::{Mat, Point2d, Point3d, Vector, no_array};
use opencv::prelude::*;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use scaleproof_core::geometry::{Rigid, homography, rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::{PARAMETERS, by_step, project_unchecked};
use scaleproof_pose::locate::{planar_branches, sqpnp};

fn camera() -> Camera {
    Camera::pinhole(1280, 960, 1180.0, 1175.0, 645.0, 472.0).with_distortion(&[-0.08, 0.02, 0.001, -0.0005])
}

/// All poses of one of OpenCV's solvers.
fn by_opencv(model: &[Point3<f64>], pixels: &[[f64; 2]], c: &Camera, method: SolvePnPMethod) -> Vec<Rigid> {
    let model: Vector<Point3d> = model.iter().map(|p| Point3d::new(p.x, p.y, p.z)).collect();
    let pixels: Vector<Point2d> = pixels.iter().map(|[x, y]| Point2d::new(*x, *y)).collect();
    let k = Mat::from_slice_2d(&[[c.fx, 0.0, c.cx], [0.0, c.fy, c.cy], [0.0, 0.0, 1.0]]).unwrap();
    let distortion: Vector<f64> = c.distortion().iter().copied().collect();
    let (mut rvecs, mut tvecs) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    let (none, mut errors) = (no_array(), no_array());
    calib3d::solve_pnp_generic(
        &model,
        &pixels,
        &k,
        &distortion,
        &mut rvecs,
        &mut tvecs,
        false,
        method,
        &none,
        &none,
        &mut errors,
    )
    .unwrap();
    let numbers = |m: Mat| <[f64; 3]>::try_from(m.data_typed::<f64>().unwrap()).unwrap();
    let both = rvecs.iter().zip(tvecs.iter());
    both.map(|(r, t)| rigid::from_rotation_vector(numbers(r), numbers(t)))
        .collect()
}

/// A camera some 300 to 1500 mm away that looks at the origin.
fn view() -> impl Strategy<Value = Rigid> {
    let turn = prop::array::uniform3(-3.0..3.0_f64);
    let place = (-120.0..120.0_f64, -90.0..90.0_f64, 300.0..1500.0_f64);
    (turn, place).prop_map(|(turn, (x, y, z))| rigid::from_rotation_vector(turn, [x * z / 900.0, y * z / 900.0, z]))
}

fn seen(points: &[Point3<f64>], pose: &Rigid, noise: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let seen = points.iter().zip(noise.iter().cycle());
    seen.map(|(p, n)| camera().project(&(pose * p)).map(|[u, v]| [u + n[0], v + n[1]]))
        .collect()
}

fn degrees_apart(a: &Rigid, b: &Rigid) -> f64 {
    a.rotation.angle_to(&b.rotation).to_degrees()
}

fn noise(px: f64) -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec(prop::array::uniform2(-px..=px), 40)
}

fn rms(points: &[Point3<f64>], pixels: &[[f64; 2]], pose: &Rigid) -> f64 {
    let Some(again) = seen(points, pose, &[[0.0; 2]]) else {
        return f64::INFINITY;
    };
    let off = again
        .iter()
        .zip(pixels)
        .map(|(a, b)| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2));
    (off.sum::<f64>() / pixels.len() as f64).sqrt()
}

/// Pixels, and their derivatives by a turn, a shift and every number of the camera: those of OpenCV's `projectPoints`.
#[test]
fn projection_and_its_derivatives_are_opencvs() {
    let mut runner = TestRunner::new(Config {
        cases: 300,
        failure_persistence: None,
        ..Config::default()
    });
    let coefficients = prop::array::uniform8(-0.05..0.05_f64);
    let place = (-0.5..0.5_f64, -0.4..0.4_f64, 200.0..1500.0_f64);
    runner
        .run(&(coefficients, place), |(k, (x, y, z))| {
            let camera = Camera::pinhole(1280, 960, 1180.0, 1175.0, 645.0, 472.0).with_distortion(&k);
            let point = Point3::new(x * z, y * z, z);
            let ours = project_unchecked(&camera.parameters(), &point);
            let points = Vector::<Point3d>::from_iter([Point3d::new(point.x, point.y, point.z)]);
            let zero = Mat::from_slice_2d(&[[0.0], [0.0], [0.0]]).unwrap();
            let intrinsics =
                Mat::from_slice_2d(&[[1180.0, 0.0, 645.0], [0.0, 1175.0, 472.0], [0.0, 0.0, 1.0]]).unwrap();
            let (mut pixels, mut jacobian) = (Vector::<Point2d>::new(), Mat::default());
            let distortion: Vector<f64> = k.iter().copied().collect();
            calib3d::project_points(
                &points,
                &zero,
                &zero,
                &intrinsics,
                &distortion,
                &mut pixels,
                &mut jacobian,
                0.0,
            )
            .unwrap();
            let their = pixels.get(0).unwrap();
            prop_assert!((ours.pixel[0] - their.x).abs() < 1e-9 && (ours.pixel[1] - their.y).abs() < 1e-9);
            if let Some(pixel) = camera.project(&point) {
                prop_assert_eq!(pixel, ours.pixel);
                prop_assert_eq!(camera.project_by_point(&point).unwrap().1, ours.by_point);
            }
            let theirs = jacobian.data_typed::<f64>().unwrap();
            let (by_pose, columns) = (by_step(&ours.by_point, &point), 6 + PARAMETERS);
            prop_assert_eq!(theirs.len(), 2 * columns);
            for row in 0..2 {
                for column in 0..columns {
                    let our = if column < 6 {
                        by_pose[(row, column)]
                    } else {
                        ours.by_camera[(row, column - 6)]
                    };
                    let their = theirs[row * columns + column];
                    prop_assert!(
                        (our - their).abs() < 1e-9 * (1.0 + their.abs()),
                        "{row} {column}: {our} {their}"
                    );
                }
            }
            Ok(())
        })
        .unwrap();
}

/// Many points, on a plane or not: the pose of OpenCV's SQPnP, or one that leaves less; with exact pixels the true one.
#[test]
fn many_points_give_opencvs_pose() {
    let mut runner = TestRunner::new(Config {
        cases: 600,
        failure_persistence: None,
        ..Config::default()
    });
    let points = prop::collection::vec((-300.0..300.0_f64, -200.0..200.0_f64, -100.0..100.0_f64), 6..30);
    let strategy = (points, any::<bool>(), view(), noise(0.5), any::<bool>());
    let compared = Cell::new(0);
    runner
        .run(&strategy, |(points, is_flat, pose, noise, is_exact)| {
            let model: Vec<_> = points
                .iter()
                .map(|(x, y, z)| Point3::new(*x, *y, if is_flat { 0.0 } else { *z }))
                .collect();
            // The planar ambiguity and points on a line are other tests' matter.
            let spread = points.iter().map(|p| p.1).fold(f64::MIN, f64::max)
                - points.iter().map(|p| p.1).fold(f64::MAX, f64::min);
            prop_assume!(spread > 60.0);
            let noise = if is_exact { vec![[0.0; 2]] } else { noise };
            let Some(pixels) = seen(&model, &pose, &noise) else {
                return Ok(());
            };
            prop_assume!(
                pixels
                    .iter()
                    .all(|[u, v]| (0.0..1280.0).contains(u) && (0.0..960.0).contains(v))
            );
            let ours = sqpnp(&model, &pixels, &camera()).unwrap();
            if is_exact {
                prop_assert!(degrees_apart(&ours, &pose) < 1e-4, "{}", degrees_apart(&ours, &pose));
                prop_assert!((ours.translation.vector - pose.translation.vector).norm() < 1e-3);
            }
            let theirs = by_opencv(&model, &pixels, &camera(), SolvePnPMethod::SOLVEPNP_SQPNP);
            let nearest = theirs
                .iter()
                .map(|t| degrees_apart(&ours, t))
                .fold(f64::INFINITY, f64::min);
            let least = theirs
                .iter()
                .map(|t| rms(&model, &pixels, t))
                .fold(f64::INFINITY, f64::min);
            compared.set(compared.get() + 1);
            prop_assert!(
                nearest < 0.02 || rms(&model, &pixels, &ours) < least,
                "{nearest}°, {least} px"
            );
            Ok(())
        })
        .unwrap();
    assert!(compared.get() > 200, "{}", compared.get());
}

/// One square: both of OpenCV's branches, each where it is.
#[test]
fn a_square_gives_opencvs_two_branches() {
    let mut runner = TestRunner::new(Config {
        cases: 600,
        failure_persistence: None,
        ..Config::default()
    });
    let half = 25.0;
    let square = [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, y]| Point3::new(x, y, 0.0));
    let compared = Cell::new(0);
    runner
        .run(&(view(), noise(0.3)), |(pose, noise)| {
            // A tag's back is not seen.
            prop_assume!((pose.rotation * Vector3::z()).dot(&pose.translation.vector) < -30.0);
            let Some(pixels) = seen(&square, &pose, &noise) else {
                return Ok(());
            };
            let pixels: [[f64; 2]; 4] = pixels.try_into().unwrap();
            let ours = planar_branches(&square, &pixels, &camera());
            prop_assert_eq!(ours.len(), 2);
            let theirs = by_opencv(&square, &pixels, &camera(), SolvePnPMethod::SOLVEPNP_IPPE_SQUARE);
            for their in theirs.iter().filter(|t| rms(&square, &pixels, t) < 3.0) {
                let nearest = ours
                    .iter()
                    .map(|o| degrees_apart(o, their))
                    .fold(f64::INFINITY, f64::min);
                prop_assert!(nearest < 0.05, "{nearest}° from {their:?}");
                compared.set(compared.get() + 1);
            }
            Ok(())
        })
        .unwrap();
    assert!(compared.get() > 200, "{}", compared.get());
}

/// Least squares over noisy points, as OpenCV's `findHomography` without outliers.
#[test]
fn a_homography_is_opencvs() {
    let mut runner = TestRunner::new(Config {
        cases: 200,
        failure_persistence: None,
        ..Config::default()
    });
    let truth =
        (-0.4..0.4_f64, -0.4..0.4_f64, -1.5..1.5_f64).prop_map(|(a, b, c)| Rotation3::from_euler_angles(a, b, c));
    runner
        .run(&(truth, noise(1.0)), |(turn, noise)| {
            let from: Vec<[f64; 2]> = (0..20)
                .map(|i| [f64::from(i % 5) * 45.0 - 90.0, f64::from(i / 5) * 50.0 - 75.0])
                .collect();
            let to: Vec<[f64; 2]> = from
                .iter()
                .zip(&noise)
                .map(|(p, n)| {
                    let q = turn * Point3::new(p[0], p[1], 0.0);
                    [
                        640.0 + 1000.0 * q.x / (q.z + 400.0) + n[0],
                        480.0 + 1000.0 * q.y / (q.z + 400.0) + n[1],
                    ]
                })
                .collect();
            let ours = homography::fitted(&from, &to).unwrap();
            let points =
                |list: &[[f64; 2]]| -> Vector<Point2d> { list.iter().map(|[x, y]| Point2d::new(*x, *y)).collect() };
            let theirs = calib3d::find_homography(&points(&from), &points(&to), &mut no_array(), 0, 3.0).unwrap();
            let theirs = nalgebra::Matrix3::from_row_slice(theirs.data_typed::<f64>().unwrap());
            for point in &from {
                let ([u, v], [x, y]) = (homography::mapped(&ours, *point), homography::mapped(&theirs, *point));
                prop_assert!((u - x).hypot(v - y) < 1e-3, "{} {}", u - x, v - y);
            }
            Ok(())
        })
        .unwrap();
}
