//! The derivatives of a corner's residual.

use nalgebra::Vector6;
use proptest::prelude::*;
use scaleproof_core::geometry::{Rigid, rigid};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::corners_in_tag_mm;
use scaleproof_rig::survey::residual::linear;

fn exp(d: &Vector6<f64>) -> Rigid {
    rigid::from_rotation_vector([d[3], d[4], d[5]], [d[0], d[1], d[2]])
}

proptest! {
    /// A small step of either pose moves the pixel as the derivative says.
    #[test]
    fn derivatives_agree_with_a_small_step(
        r in prop::array::uniform3(-0.6..0.6_f64),
        t in prop::array::uniform3(-80.0..80.0_f64),
        axis in 0_usize..6,
    ) {
        let camera = Camera::pinhole(1280, 960, 1180.0, 1170.0, 640.0, 480.0).with_distortion(&[-0.08, 0.03, 0.001, -0.002]);
        let photo = rigid::from_rotation_vector(r, [t[0], t[1], 800.0 + t[2]]);
        let tag = rigid::from_rotation_vector([r[2], r[0], r[1]], [t[2], t[0], t[1]]);
        let (corner, seen) = (corners_in_tag_mm(50.0)[1], [600.0, 500.0]);
        let at = linear(&(photo * tag), &corner, &seen, &camera).unwrap();
        let mut step = Vector6::zeros();
        step[axis] = 1e-4;
        let residual = |pose: Rigid| linear(&pose, &corner, &seen, &camera).unwrap().residual;
        for (moved, derivative) in [(exp(&step) * photo * tag, at.by_photo), (photo * tag * exp(&step), at.by_tag)] {
            let wanted = (residual(moved) - at.residual) / 1e-4;
            prop_assert!((wanted - derivative.column(axis)).norm() < 2e-3 * (1.0 + wanted.norm()));
        }
    }
}
