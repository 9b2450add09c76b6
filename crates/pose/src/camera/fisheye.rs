//! The fisheye model of Kannala and Brandt (2006, "A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye
//! Lenses", its radially symmetric part), with the coefficients of OpenCV's `cv::fisheye` and Kalibr's `equidistant`: a ray at the angle θ (rad)
//! to the optical axis lands θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸) focal lengths from the principal point.
//!
//! Coefficient arrays have eight entries, as for Brown–Conrady; only the first four, k1 to k4, are used.

use nalgebra::{Matrix2x3, Point3};

/// Largest angle to the optical axis of a ray that has a pixel: points need a positive depth, and at depth 1 this ray is 11 units off the axis.
const FURTHEST_DEG: f64 = 85.0;
const NEWTON_STEPS: usize = 50;

/// Returns θ_d at an angle θ (rad), and its derivative by θ.
fn distorted([k1, k2, k3, k4, ..]: &[f64; 8], angle: f64) -> (f64, f64) {
    let t = angle * angle;
    (
        angle * (1.0 + t * (k1 + t * (k2 + t * (k3 + t * k4)))),
        1.0 + t * (3.0 * k1 + t * (5.0 * k2 + t * (7.0 * k3 + t * 9.0 * k4))),
    )
}

/// Returns a point's distance from the optical axis, the angle of its ray to the axis (rad), and the unit direction of the point in the image.
fn polar(p: &Point3<f64>) -> (f64, f64, [f64; 2]) {
    let off_axis = p.x.hypot(p.y);
    let direction = if off_axis > 0.0 {
        [p.x / off_axis, p.y / off_axis]
    } else {
        [1.0, 0.0]
    };
    (off_axis, off_axis.atan2(p.z), direction)
}

/// Projects a point of the camera frame, in focal lengths from the principal point, and returns the derivative by the point.
pub(super) fn project(k: &[f64; 8], p: &Point3<f64>) -> ([f64; 2], Matrix2x3<f64>) {
    let (off_axis, angle, [cos, sin]) = polar(p);
    let (radius, by_angle) = distorted(k, angle);
    let by_depth = -by_angle / p.coords.norm_squared();
    // The image's scale across the radius and along it; on the axis both are 1 / depth.
    let across = if off_axis > 0.0 { radius / off_axis } else { 1.0 / p.z };
    let more = -by_depth * p.z - across;
    let by_point = Matrix2x3::new(
        across + more * cos * cos,
        more * cos * sin,
        by_depth * p.x,
        more * cos * sin,
        across + more * sin * sin,
        by_depth * p.y,
    );
    ([radius * cos, radius * sin], by_point)
}

/// Returns the derivatives of [`project`] by the coefficients.
pub(super) fn by_coefficients(p: &Point3<f64>) -> [[f64; 2]; 8] {
    let (_, angle, direction) = polar(p);
    let by = |power| direction.map(|d| angle.powi(power) * d);
    let none = [0.0; 2];
    [by(3), by(5), by(7), by(9), none, none, none, none]
}

/// Returns the point at depth 1 that projects to `target`, in focal lengths from the principal point; `None` beyond the radius `widest` at depth 1.
pub(super) fn point_at(k: &[f64; 8], target: [f64; 2], widest: f64) -> Option<[f64; 2]> {
    let radius = target[0].hypot(target[1]);
    // Newton's method on θ, in a bracket that is halved where a step would leave it.
    let (mut low, mut high) = (0.0, widest.atan());
    if radius == 0.0 {
        return Some(target);
    }
    if !radius.is_finite() || radius > distorted(k, high).0 {
        return None;
    }
    let mut angle = radius.min(high);
    for _ in 0..NEWTON_STEPS {
        let (at, by_angle) = distorted(k, angle);
        if at > radius {
            high = angle;
        } else {
            low = angle;
        }
        let newton = angle + (radius - at) / by_angle;
        let next = if (low..=high).contains(&newton) {
            newton
        } else {
            (low + high) / 2.0
        };
        if (next - angle).abs() <= f64::EPSILON * angle {
            break;
        }
        angle = next;
    }
    Some(target.map(|c| c * angle.tan() / radius))
}

/// Returns the radius at depth 1 up to which θ_d grows with θ, searched up to [`FURTHEST_DEG`].
pub(super) fn valid_radius(k: &[f64; 8]) -> f64 {
    const PER_DEG: f64 = 4.0;
    let steps = (FURTHEST_DEG * PER_DEG) as u32;
    let angle = |step: u32| (f64::from(step) / PER_DEG).to_radians();
    let grows = |step: &u32| distorted(k, angle(*step)).1 > 0.0;
    angle((1..=steps).take_while(grows).last().unwrap_or(0)).tan()
}
