//! How a pixel moves when a point or a pose moves: the derivatives every least-squares problem over corners needs.
//!
//! A pose `T_camera_x` is moved by a step `(ω, υ)` on its left: `T ← (exp(ω), υ) · T`, ω in radians, υ in mm, both in the
//! camera frame (Solà, Deray & Atchuthan 2018, "A micro Lie theory", left perturbation). A point `p` of the camera frame
//! then moves by `ω × p + υ`.

use nalgebra::{Matrix2x3, Matrix2x6, Point3, Translation3, UnitQuaternion, Vector6};

use crate::camera::Camera;
use crate::geometry::Rigid;

/// The pixel of a point in the camera frame (mm), and its derivative by that point, px per mm. `None` where
/// [`Camera::project`] has no pixel.
///
/// The derivative of OpenCV's pinhole with rational Brown–Conrady distortion (OpenCV documentation, "Camera Calibration and
/// 3D Reconstruction").
pub fn pixel_by_point(camera: &Camera, p: &Point3<f64>) -> Option<([f64; 2], Matrix2x3<f64>)> {
    let pixel = camera.project(p)?;
    let [k1, k2, p1, p2, k3, k4, k5, k6] = *camera.distortion();
    let (x, y) = (p.x / p.z, p.y / p.z);
    let r2 = x * x + y * y;
    let (above, below) = (
        1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)),
        1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)),
    );
    let (above_by_r2, below_by_r2) = (
        k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3),
        k4 + r2 * (2.0 * k5 + 3.0 * r2 * k6),
    );
    let radial = above / below;
    let radial_by_r2 = (above_by_r2 - radial * below_by_r2) / below;
    let mixed = 2.0 * x * y * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y;
    let (ux, uy) = (
        camera.fx * (radial + 2.0 * x * x * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x),
        camera.fx * mixed,
    );
    let (vx, vy) = (
        camera.fy * mixed,
        camera.fy * (radial + 2.0 * y * y * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x),
    );
    let by_point = Matrix2x3::new(ux, uy, -(ux * x + uy * y), vx, vy, -(vx * x + vy * y)) / p.z;
    Some((pixel, by_point))
}

/// The pixel of a point of frame x (mm) under the pose `T_camera_x`, and its derivative by a step of the pose: columns ω
/// (px per rad), υ (px per mm).
pub fn pixel_by_pose(camera: &Camera, pose: &Rigid, point: &Point3<f64>) -> Option<([f64; 2], Matrix2x6<f64>)> {
    let p = pose * point;
    let (pixel, by_point) = pixel_by_point(camera, &p)?;
    let by_turn = -by_point * p.coords.cross_matrix();
    let mut by_pose = Matrix2x6::zeros();
    by_pose.fixed_columns_mut::<3>(0).copy_from(&by_turn);
    by_pose.fixed_columns_mut::<3>(3).copy_from(&by_point);
    Some((pixel, by_pose))
}

/// The pose after a step (ω in rad, υ in mm) on its left.
pub fn stepped(pose: &Rigid, step: &Vector6<f64>) -> Rigid {
    let (turn, shift) = (step.fixed_rows::<3>(0), step.fixed_rows::<3>(3));
    let mut step = Rigid::from_parts(
        Translation3::from(shift.into_owned()),
        UnitQuaternion::from_scaled_axis(turn.into_owned()),
    ) * pose;
    // Products of many unit quaternions drift.
    step.rotation.renormalize();
    step
}

/// The step (ω in rad, υ in mm) that takes one pose to another: the inverse of [`stepped`].
pub fn step_between(from: &Rigid, to: &Rigid) -> Vector6<f64> {
    let step = to * from.inverse();
    let (turn, shift) = (step.rotation.scaled_axis(), step.translation.vector);
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rigid;
    use proptest::prelude::*;

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
            let (_, by_pose) = pixel_by_pose(&camera(), &pose, &point).unwrap();
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
        fn the_step_between_two_poses_arrives(
            turn in prop::array::uniform3(-0.5..0.5_f64),
            shift in prop::array::uniform3(-80.0..80.0_f64),
        ) {
            let from = rigid::from_rotation_vector([0.3, -0.2, 1.1], [10.0, 20.0, 800.0]);
            let to = rigid::from_rotation_vector(turn, shift);
            let arrived = stepped(&from, &step_between(&from, &to));
            prop_assert!(arrived.rotation.angle_to(&to.rotation) < 1e-9);
            prop_assert!((arrived.translation.vector - to.translation.vector).norm() < 1e-9);
        }
    }
}
