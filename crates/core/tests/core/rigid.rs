//! Rigid transforms.

use proptest::prelude::*;
use scaleproof_core::geometry::rigid::{from_rotation_vector, step_between, stepped, to_rotation_vector};

proptest! {
    #[test]
    fn the_step_between_two_poses_arrives(
        turn in prop::array::uniform3(-0.5..0.5_f64),
        shift in prop::array::uniform3(-80.0..80.0_f64),
    ) {
        let start = from_rotation_vector([0.3, -0.2, 1.1], [10.0, 20.0, 800.0]);
        let to = from_rotation_vector(turn, shift);
        let arrived = stepped(&start, &step_between(&start, &to));
        prop_assert!(arrived.rotation.angle_to(&to.rotation) < 1e-9);
        prop_assert!((arrived.translation.vector - to.translation.vector).norm() < 1e-9);
    }

    #[test]
    fn rotation_vectors_round_trip(r in prop::array::uniform3(-1.7..1.7_f64), t in prop::array::uniform3(-900.0..900.0_f64)) {
        let (r2, t2) = to_rotation_vector(&from_rotation_vector(r, t));
        for i in 0..3 {
            prop_assert!((r[i] - r2[i]).abs() < 1e-9 && (t[i] - t2[i]).abs() < 1e-9);
        }
    }
}
