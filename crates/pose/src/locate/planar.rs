//! Both poses of a planar target such as a tag or a board (IPPE: Collins & Bartoli, "Infinitesimal Plane-Based Pose Estimation", IJCV 2014).

use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3};

use crate::camera::Camera;
use scaleproof_core::geometry::{Rigid, homography, rigid};

/// Returns `T_camera_plane` of both branches of a planar target; empty if its points are collinear or beyond the lens model's range. `in_plane_mm`:
/// at least four points in the target's own frame, z = 0.
pub fn planar_branches(in_plane_mm: &[Point3<f64>], seen_px: &[[f64; 2]], camera: &Camera) -> Vec<Rigid> {
    both(in_plane_mm, seen_px, camera).map_or_else(Vec::new, Vec::from)
}

fn both(in_plane_mm: &[Point3<f64>], seen_px: &[[f64; 2]], camera: &Camera) -> Option<[Rigid; 2]> {
    let seen = directions(seen_px, camera)?;
    // The branches differ by the tilt of the plane about the origin, so the points are centred there.
    let middle = in_plane_mm.iter().map(|p| p.coords).sum::<Vector3<f64>>() / in_plane_mm.len() as f64;
    let centred: Vec<_> = in_plane_mm.iter().map(|p| p - middle).collect();
    let plane: Vec<_> = centred.iter().map(|p| [p.x, p.y]).collect();
    let map = homography::fitted(&plane, &seen)?;
    let pose = |rotation| {
        let translation = translation(&rotation, &centred, &seen)? - rotation * middle;
        Some(rigid::from_matrix(rotation, translation))
    };
    let [one, other] = rotations(&map)?;
    Some([pose(one)?, pose(other)?])
}

/// Returns the two rotations that agree with the homography from the plane to depth 1 near its origin (section 4 of the paper).
fn rotations(map: &Matrix3<f64>) -> Option<[Matrix3<f64>; 2]> {
    let h = map / map[(2, 2)];
    let centre = Vector2::new(h[(0, 2)], h[(1, 2)]);
    let jacobian = Matrix2::from_fn(|i, j| h[(i, j)] - h[(2, j)] * centre[i]);
    let turn = towards(centre);
    let projected = Matrix2::from_fn(|i, j| turn[(i, j)] - centre[i] * turn[(2, j)]);
    let scaled = projected.try_inverse()? * jacobian;
    let size = scaled.svd(false, false).singular_values.max();
    if !(size.is_finite() && size > 0.0) {
        return None;
    }
    // Upper left block of the rotation in the frame of the ray, and the remainder for the third row from the columns' unit length, up to its sign.
    let upper = scaled / size;
    let left = Matrix2::identity() - upper.transpose() * upper;
    let [b1, b2] = [left[(0, 0)], left[(1, 1)]].map(|v| v.max(0.0).sqrt());
    let b2 = if left[(0, 1)] < 0.0 { -b2 } else { b2 };
    let branch = |sign: f64| {
        let first = Vector3::new(upper[(0, 0)], upper[(1, 0)], sign * b1);
        let second = Vector3::new(upper[(0, 1)], upper[(1, 1)], sign * b2);
        turn * Matrix3::from_columns(&[first, second, first.cross(&second)])
    };
    Some([1.0, -1.0].map(|sign| nearest_rotation(&branch(sign))))
}

/// Returns the smallest rotation from the optical axis to the direction of a point at depth 1.
fn towards(point: Vector2<f64>) -> Matrix3<f64> {
    let direction = Vector3::new(point.x, point.y, 1.0);
    let turn = nalgebra::Rotation3::rotation_between(&Vector3::z(), &direction);
    turn.map_or_else(Matrix3::identity, nalgebra::Rotation3::into_inner)
}

/// Returns the points at depth 1 that pixels show; `None` if one is beyond the lens model's range.
fn directions(pixels: &[[f64; 2]], camera: &Camera) -> Option<Vec<[f64; 2]>> {
    pixels.iter().map(|pixel| camera.point_at(*pixel)).collect()
}

/// Returns the matrix of the quadratic form (X − uZ)² + (Y − vZ)² of a point (X, Y, Z).
pub(super) fn square([u, v]: [f64; 2]) -> Matrix3<f64> {
    Matrix3::new(1.0, 0.0, -u, 0.0, 1.0, -v, -u, -v, u * u + v * v)
}

/// Returns the translation that minimises Σ (X − uZ)² + (Y − vZ)² for a rotation; `None` if the directions do not determine it.
pub(super) fn translation(rotation: &Matrix3<f64>, model: &[Point3<f64>], seen: &[[f64; 2]]) -> Option<Vector3<f64>> {
    let (mut sum, mut moved) = (Matrix3::zeros(), Vector3::zeros());
    for (point, ray) in model.iter().zip(seen) {
        let q = square(*ray);
        sum += q;
        moved += q * (rotation * point.coords);
    }
    Some(-sum.try_inverse()? * moved)
}

/// Returns the rotation nearest to a matrix (Frobenius norm; Kabsch 1976).
pub(super) fn nearest_rotation(m: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = m.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let sign = (u * v).determinant().signum();
    // nalgebra sorts singular values, so the last is the smallest.
    u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v
}
