//! Distances of a tag's corners from where a pose puts them, and their derivatives by the poses.

use nalgebra::{Matrix2x3, Matrix2x6, Point3, Vector2};

use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::corners_in_tag_mm;

/// Squared distance that stands for a corner without a pixel: behind the camera, or beyond the lens model. px².
pub(super) const NO_PIXEL: f64 = 1e8;

/// Returns the squared distance in px² between each seen corner and its projection.
pub(super) fn squared_px(camera_tag: &Rigid, size_mm: f64, seen_px: &[[f64; 2]; 4], camera: &Camera) -> [f64; 4] {
    let corners = corners_in_tag_mm(size_mm);
    std::array::from_fn(|i| match camera.project(&(camera_tag * corners[i])) {
        Some([x, y]) => (x - seen_px[i][0]).powi(2) + (y - seen_px[i][1]).powi(2),
        None => NO_PIXEL,
    })
}

/// Returns the root mean square over four corners, px.
pub(super) fn rms_px(squared_px: [f64; 4]) -> f64 {
    (squared_px.iter().sum::<f64>() / 4.0).sqrt()
}

/// One corner, linearised: residual (projected minus seen, px) and its derivatives by translation (mm) and rotation (rad).
pub struct LinearisedCorner {
    pub residual: Vector2<f64>,
    /// Derivative by `δ` in `T_camera_model ← exp(δ) · T_camera_model`.
    pub by_photo: Matrix2x6<f64>,
    /// Derivative by `δ` in `T_model_tag ← T_model_tag · exp(δ)`.
    pub by_tag: Matrix2x6<f64>,
}

/// Linearises a corner; `None` when it has no pixel.
///
/// Chain rule over `P = T_camera_tag · x`: dP is `t + ω × P` for the photo and `R (t + ω × x)` for the tag.
pub fn linear(
    camera_tag: &Rigid,
    corner: &Point3<f64>,
    seen_px: &[f64; 2],
    camera: &Camera,
) -> Option<LinearisedCorner> {
    let p = camera_tag * corner;
    let ([x, y], by_point) = camera.project_by_point(&p)?;
    let side_by_side = |m: Matrix2x3<f64>, at: &Point3<f64>| {
        let turned = m * -at.coords.cross_matrix();
        Matrix2x6::from_fn(|r, c| if c < 3 { m[(r, c)] } else { turned[(r, c - 3)] })
    };
    let rotation = camera_tag.rotation.to_rotation_matrix();
    Some(LinearisedCorner {
        residual: Vector2::new(x - seen_px[0], y - seen_px[1]),
        by_photo: side_by_side(by_point, &p),
        by_tag: side_by_side(by_point * rotation.matrix(), corner),
    })
}
