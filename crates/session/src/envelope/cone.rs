//! Clipping of a line to a lens's field of view.

use nalgebra::Point3;

/// Returns the part of a segment inside the cone x² + y² ≤ (R z)², z > 0 about the camera's axis, as two points at depth 1. Points in the camera
/// frame.
///
/// The cone is convex, so there is at most one such part; it ends at roots of a quadratic in the segment's parameter.
pub fn part_inside(a: &Point3<f64>, b: &Point3<f64>, radius: f64) -> Option<[[f64; 2]; 2]> {
    let d = b - a;
    let squared = radius * radius;
    let beyond = |p: &Point3<f64>| p.x * p.x + p.y * p.y - squared * p.z * p.z;
    let (c2, c1) = (
        d.x * d.x + d.y * d.y - squared * d.z * d.z,
        a.x * d.x + a.y * d.y - squared * a.z * d.z,
    );
    let mut ends = vec![0.0];
    ends.extend(roots(c2, c1, beyond(a)).into_iter().filter(|t| *t > 0.0 && *t < 1.0));
    ends.push(1.0);
    ends.sort_by(f64::total_cmp);
    let inside = |t: f64| {
        let p = a + d * t;
        p.z > 0.0 && beyond(&p) <= 0.0
    };
    let part = ends.windows(2).find(|w| w[1] > w[0] && inside((w[0] + w[1]) / 2.0))?;
    let at_depth_1 = |t: f64| {
        let p = a + d * t;
        let (x, y) = (p.x / p.z, p.y / p.z);
        // Rounding must not leave the end outside the cone.
        let shrink = (radius / x.hypot(y)).min(1.0);
        (x.is_finite() && y.is_finite()).then_some([x * shrink, y * shrink])
    };
    Some([at_depth_1(part[0])?, at_depth_1(part[1])?])
}

/// Returns the real roots of c2 t² + 2 c1 t + c0.
fn roots(c2: f64, c1: f64, c0: f64) -> Vec<f64> {
    let root = (c1 * c1 - c2 * c0).sqrt();
    if root.is_nan() {
        return Vec::new();
    }
    // The form without subtraction of nearly equal numbers.
    let q = -(c1 + root.copysign(c1));
    [q / c2, c0 / q].into_iter().filter(|t| t.is_finite()).collect()
}
