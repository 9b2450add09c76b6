//! What the direct solvers share: directions of pixels, and the translation that a rotation leaves.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::camera::Camera;

/// The points at depth 1 that pixels show; `None` where the lens model does not reach one.
pub(super) fn at(pixels: &[[f64; 2]], camera: &Camera) -> Option<Vec<[f64; 2]>> {
    pixels.iter().map(|pixel| camera.point_at(*pixel)).collect()
}

/// The rows of (1, 0, −u) and (0, 1, −v), squared and added: what a point (X, Y, Z) leaves of (X − uZ)² + (Y − vZ)².
pub(super) fn square([u, v]: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, -u, 0.0, 1.0, -v, -u, -v, u * u + v * v)
}

/// The translation that leaves the least Σ (X − uZ)² + (Y − vZ)² for a rotation; `None` when the directions leave it open.
pub(super) fn translation(rotation: &Matrix3<f64>, model: &[Point3<f64>], seen: &[[f64; 2]]) -> Option<Vector3<f64>> {
    let (mut sum, mut moved) = (Matrix3::zeros(), Vector3::zeros());
    for (point, ray) in model.iter().zip(seen) {
        let q = square(*ray);
        sum += q;
        moved += q * (rotation * point.coords);
    }
    Some(-sum.try_inverse()? * moved)
}

/// The rotation nearest to a matrix (Frobenius norm; Kabsch 1976).
pub(super) fn nearest_rotation(m: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = m.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let sign = (u * v).determinant().signum();
    // nalgebra sorts singular values, so the last is the smallest.
    u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v
}
