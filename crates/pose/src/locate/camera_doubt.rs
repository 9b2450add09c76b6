//! Pose uncertainty from the errors of the camera's focal lengths and principal point.

use nalgebra::{Matrix2x5, Matrix6, RowVector5, SMatrix};

use super::matches::Corners;
use crate::camera::Camera;
use scaleproof_core::geometry::Rigid;

/// Relative error of fx and fy, each by itself, of a camera calibrated without error: focus and temperature move the lens, and a photo made smaller
/// has whole pixels. Photos made smaller 2 to 8 times and enlarged again are off by up to 0.2 % (`benches/pose_speed.py`).
pub const FOCAL_SHARE: f64 = 1e-3;

/// Covariance of the step (ω in rad, υ in mm) from a pose with the least squared residuals to the true one, by the camera's errors alone. `None` if
/// the corners do not determine the pose.
///
/// First derivatives: residuals that change by C for each parameter of the camera move the pose by (JᵀJ)⁻¹JᵀC. A calibration's errors of fx and fy
/// are treated as one, since both come from the distance of its board; those of its principal point as independent.
pub(super) fn covariance(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<Matrix6<f64>> {
    let (mut information, mut moved) = (Matrix6::zeros(), SMatrix::<f64, 6, 5>::zeros());
    for (point, [u, v]) in corners.model_mm.iter().zip(&corners.image_px) {
        let (_, by_pose) = camera.project_by_pose(pose, point)?;
        information += by_pose.transpose() * by_pose;
        moved += by_pose.transpose() * by_number([u - camera.cx, v - camera.cy], camera);
    }
    let steps = information.cholesky()?.solve(&moved);
    Some(steps * steps.transpose())
}

/// Returns the shift of a pixel by one σ of each of the camera's errors: fx, fy, both, cx, cy.
fn by_number([u, v]: [f64; 2], camera: &Camera) -> Matrix2x5<f64> {
    let both = focal_share(camera);
    let [cx, cy] = camera.sigma_px.map_or([0.0; 2], |[_, _, cx, cy]| [cx, cy]);
    Matrix2x5::from_rows(&[
        RowVector5::new(FOCAL_SHARE * u, 0.0, both * u, cx, 0.0),
        RowVector5::new(0.0, FOCAL_SHARE * v, both * v, 0.0, cy),
    ])
}

/// Returns the relative standard deviation of the focal length that the camera file states.
fn focal_share(camera: &Camera) -> f64 {
    // A guess gives limits, assumed to bound a uniform distribution.
    let guessed = camera
        .guess
        .map_or(0.0, |guess| guess.focal_percent / 100.0 / 3f64.sqrt());
    camera.sigma_px.map_or(guessed, |[fx, fy, ..]| {
        ((fx / camera.fx).powi(2) + (fy / camera.fy).powi(2)).sqrt() / 2f64.sqrt()
    })
}
