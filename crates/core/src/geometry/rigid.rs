//! Rigid transforms `T_a_b`: they map b-coordinates to a-coordinates, in millimetres.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3, Vector6};

/// A rotation and a translation in millimetres.
pub type Rigid = Isometry3<f64>;

/// Creates a transform from a rotation matrix (assumed orthonormal, right-handed) and a translation in millimetres.
pub fn from_matrix(rotation: Matrix3<f64>, translation: Vector3<f64>) -> Rigid {
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    Rigid::from_parts(
        Translation3::from(translation),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

/// Creates a transform from a rotation vector (axis times angle in radians, OpenCV's `rvec`) and a translation in millimetres.
pub fn from_rotation_vector(rvec: [f64; 3], tvec: [f64; 3]) -> Rigid {
    Rigid::new(Vector3::from(tvec), Vector3::from(rvec))
}

/// Returns the rotation vector (radians) and translation (mm) of a transform: OpenCV's `rvec` and `tvec`.
pub fn to_rotation_vector(t: &Rigid) -> ([f64; 3], [f64; 3]) {
    (t.rotation.scaled_axis().into(), t.translation.vector.into())
}

/// Returns the 4×4 homogeneous matrix, row by row, as JSON files carry it.
pub fn rows(t: &Rigid) -> [[f64; 4]; 4] {
    let m = t.to_homogeneous();
    std::array::from_fn(|r| std::array::from_fn(|c| m[(r, c)]))
}

/// Returns the pose `T_a_b` after a step (ω in rad, υ in mm) on its left: `(exp(ω), υ) · T`, both in frame a (Solà, Deray & Atchuthan 2018,
/// "A micro Lie theory", left perturbation). A point `p` of frame a then moves by `ω × p + υ`.
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

/// Returns the step by which [`stepped`] takes one pose to another.
pub fn step_between(from: &Rigid, to: &Rigid) -> Vector6<f64> {
    let step = to * from.inverse();
    let (turn, shift) = (step.rotation.scaled_axis(), step.translation.vector);
    Vector6::new(turn.x, turn.y, turn.z, shift.x, shift.y, shift.z)
}
