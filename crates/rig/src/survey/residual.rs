//! How far a tag's corners are from where a pose puts them, and how that changes with the poses.

use nalgebra::{Matrix2x3, Matrix2x6, Point3, Vector2};

use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::corners_in_tag_mm;

/// Squared distance that stands for a corner without a pixel: behind the camera, or beyond the lens model. px².
pub(super) const NO_PIXEL: f64 = 1e8;

/// Squared distance in px² between each seen corner and its projection.
pub(super) fn squared_px(camera_tag: &Rigid, size_mm: f64, seen_px: &[[f64; 2]; 4], camera: &Camera) -> [f64; 4] {
    let corners = corners_in_tag_mm(size_mm);
    std::array::from_fn(|i| match camera.project(&(camera_tag * corners[i])) {
        Some([x, y]) => (x - seen_px[i][0]).powi(2) + (y - seen_px[i][1]).powi(2),
        None => NO_PIXEL,
    })
}

/// Root mean square over four corners, px.
pub(super) fn rms_px(squared_px: [f64; 4]) -> f64 {
    (squared_px.iter().sum::<f64>() / 4.0).sqrt()
}

/// One corner, linearised: residual (projected minus seen, px) and its derivatives by translation (mm) and rotation (rad).
pub(super) struct LinearisedCorner {
    pub residual: Vector2<f64>,
    /// By `δ` in `T_camera_model ← exp(δ) · T_camera_model`.
    pub by_photo: Matrix2x6<f64>,
    /// By `δ` in `T_model_tag ← T_model_tag · exp(δ)`.
    pub by_tag: Matrix2x6<f64>,
}

/// `None` when the corner has no pixel.
///
/// Chain rule over `P = T_camera_tag · x`: dP is `t + ω × P` for the photo and `R (t + ω × x)` for the tag.
pub(super) fn linear(
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

#[cfg(test)]
mod tests {
    use nalgebra::Vector6;
    use proptest::prelude::*;

    use super::*;
    use scaleproof_core::geometry::rigid;

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
}
