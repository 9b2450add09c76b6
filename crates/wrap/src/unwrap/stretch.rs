//! How much a triangle is stretched on its way to the paper.

use nalgebra::{Matrix2, Point3, Vector2};

/// A triangle of the surface laid into the plane as it is: its first corner at the origin, its second on the x axis.
pub(super) fn laid(corners: &[Point3<f64>; 3]) -> [Vector2<f64>; 2] {
    let (b, c) = (corners[1] - corners[0], corners[2] - corners[0]);
    let length = b.norm();
    [
        Vector2::new(length, 0.0),
        Vector2::new(b.dot(&c) / length, b.cross(&c).norm() / length),
    ]
}

/// The singular values of the affine map from a triangle of the surface to the paper, larger first; the smaller is negative where
/// the triangle is flipped (Sander et al. 2001, section 3, for the direction from paper to surface).
pub(super) fn singular_values(laid: &[Vector2<f64>; 2], flat: &[Vector2<f64>; 3]) -> [f64; 2] {
    let paper = Matrix2::from_columns(&[flat[1] - flat[0], flat[2] - flat[0]]);
    let [b, c] = laid;
    // The inverse of the upper triangular matrix with the columns b and c.
    let (x, y) = (1.0 / b.x, 1.0 / c.y);
    let map = paper * Matrix2::new(x, -c.x * x * y, 0.0, y);
    let (plus, minus) = (
        Vector2::new(map[(0, 0)] + map[(1, 1)], map[(1, 0)] - map[(0, 1)]).norm(),
        Vector2::new(map[(0, 0)] - map[(1, 1)], map[(1, 0)] + map[(0, 1)]).norm(),
    );
    [(plus + minus) / 2.0, (plus - minus) / 2.0]
}

/// 1 where lengths are kept; infinite where the triangle is flipped.
pub(super) fn stretch([large, small]: [f64; 2]) -> f64 {
    if small > 0.0 {
        large.max(1.0 / small).max(1.0)
    } else {
        f64::INFINITY
    }
}

/// The value that a share of the area does not exceed, of pairs of value and area.
pub(super) fn percentile(mut values: Vec<(f64, f64)>, share: f64) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    let reached = values.iter().find(|(_, area)| {
        below += area;
        below >= share * total
    });
    reached.or(values.last()).map_or(1.0, |(value, _)| *value)
}
