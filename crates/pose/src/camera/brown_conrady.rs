//! Brown–Conrady distortion as OpenCV's rational model writes it (OpenCV documentation, "Camera Calibration and 3D Reconstruction").

use nalgebra::Matrix2;

/// Distorts normalised coordinates (depth 1); returns the result and its derivative by them.
pub(super) fn distort(k: &[f64; 8], x: f64, y: f64) -> ([f64; 2], Matrix2<f64>) {
    let [k1, k2, p1, p2, k3, k4, k5, k6] = *k;
    let r2 = x * x + y * y;
    let (above, below) = radial_terms(k, r2);
    let (above_by_r2, below_by_r2) = (
        k1 + r2 * (2.0 * k2 + 3.0 * r2 * k3),
        k4 + r2 * (2.0 * k5 + 3.0 * r2 * k6),
    );
    let radial = above / below;
    let radial_by_r2 = (above_by_r2 - radial * below_by_r2) / below;
    let mixed = 2.0 * x * y * radial_by_r2 + 2.0 * p1 * x + 2.0 * p2 * y;
    let distorted = [
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    ];
    let by_xy = Matrix2::new(
        radial + 2.0 * x * x * radial_by_r2 + 2.0 * p1 * y + 6.0 * p2 * x,
        mixed,
        mixed,
        radial + 2.0 * y * y * radial_by_r2 + 6.0 * p1 * y + 2.0 * p2 * x,
    );
    (distorted, by_xy)
}

/// Returns the derivatives of the distorted coordinates by k1, k2, p1, p2, k3, k4, k5, k6.
pub(super) fn by_coefficients(k: &[f64; 8], x: f64, y: f64) -> [[f64; 2]; 8] {
    let r2 = x * x + y * y;
    let (above, below) = radial_terms(k, r2);
    let radial = |by: f64| [x * by / below, y * by / below];
    let down = -above / below;
    [
        radial(r2),
        radial(r2 * r2),
        [2.0 * x * y, r2 + 2.0 * y * y],
        [r2 + 2.0 * x * x, 2.0 * x * y],
        radial(r2 * r2 * r2),
        radial(down * r2),
        radial(down * r2 * r2),
        radial(down * r2 * r2 * r2),
    ]
}

/// Returns numerator and denominator of the radial distortion.
fn radial_terms([k1, k2, _, _, k3, k4, k5, k6]: &[f64; 8], r2: f64) -> (f64, f64) {
    (
        1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)),
        1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)),
    )
}

/// Returns the first radius at which the distorted radius of Brown–Conrady stops growing, searched up to 80° off the axis.
pub(super) fn valid_radius(coefficients: &[f64; 8]) -> f64 {
    const STEP: f64 = 0.01;
    let furthest = 80f64.to_radians().tan();
    let distorted = |r: f64| {
        let (above, below) = radial_terms(coefficients, r * r);
        r * (above / below)
    };
    let mut r = 0.0;
    while r < furthest && distorted(r + STEP) > distorted(r) {
        r += STEP;
    }
    r
}
