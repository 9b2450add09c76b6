//! The derivatives of the projection.

use nalgebra::{Point3, Vector6};
use proptest::prelude::*;
use scaleproof_core::geometry::rigid::{self, stepped};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::{PARAMETERS, project_unchecked};

fn camera() -> Camera {
    Camera::pinhole(1280, 960, 1180.0, 1210.0, 648.5, 473.5)
        .with_distortion(&[-0.2, 0.06, 0.001, -0.002, 0.01, 0.02, 0.003, 0.001])
}

proptest! {
    #[test]
    fn the_derivative_is_that_of_finite_differences(
        turn in prop::array::uniform3(-0.3..0.3_f64),
        shift in prop::array::uniform3(-80.0..80.0_f64),
        at in prop::array::uniform3(-150.0..150.0_f64),
    ) {
        let pose = rigid::from_rotation_vector(turn, [shift[0], shift[1], 800.0 + shift[2]]);
        let point = Point3::from(at);
        let (_, by_pose) = camera().project_by_pose(&pose, &point).unwrap();
        for axis in 0..6 {
            let half = if axis < 3 { 1e-6 } else { 1e-3 };
            let pixel = |sign: f64| {
                let mut step = Vector6::zeros();
                step[axis] = sign * half;
                camera().project(&(stepped(&pose, &step) * point)).unwrap()
            };
            let (after, before) = (pixel(1.0), pixel(-1.0));
            for row in 0..2 {
                let difference = (after[row] - before[row]) / (2.0 * half);
                let off = (by_pose[(row, axis)] - difference).abs();
                prop_assert!(off < 1e-5 * (1.0 + difference.abs()), "row {row}, axis {axis}: off by {off}");
            }
        }
    }

    #[test]
    fn the_derivative_by_the_camera_is_that_of_finite_differences(x in -0.6..0.6_f64, y in -0.5..0.5_f64) {
        let (parameters, point) = (camera().parameters(), Point3::new(700.0 * x, 700.0 * y, 700.0));
        let at = project_unchecked(&parameters, &point);
        prop_assert_eq!(Some(at.pixel), camera().project(&point));
        for axis in 0..PARAMETERS {
            let half = if axis < 4 { 1e-3 } else { 1e-6 };
            let pixel = |sign: f64| {
                let mut moved = parameters;
                moved.values[axis] += sign * half;
                project_unchecked(&moved, &point).pixel
            };
            let (after, before) = (pixel(1.0), pixel(-1.0));
            for row in 0..2 {
                let difference = (after[row] - before[row]) / (2.0 * half);
                let off = (at.by_camera[(row, axis)] - difference).abs();
                prop_assert!(off < 1e-5 * (1.0 + difference.abs()), "row {row}, axis {axis}: off by {off}");
            }
        }
    }
}
