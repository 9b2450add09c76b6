//! The two poses that explain a square's four corners almost equally well.

use super::residual::{rms_px, squared_px};
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::planar_branches;
use scaleproof_pose::scene::corners_in_tag_mm;

/// Both branches, `T_camera_tag`, the better first; none when there is no pose before the camera.
pub(super) fn branches(size_mm: f64, corners_px: &[[f64; 2]; 4], camera: &Camera) -> Vec<Rigid> {
    let mut found = planar_branches(&corners_in_tag_mm(size_mm), corners_px, camera);
    let rms = |pose: &Rigid| rms_px(squared_px(pose, size_mm, corners_px, camera));
    found.retain(|pose| pose.translation.z > 0.0 && rms(pose) < 100.0);
    found.sort_by(|a, b| rms(a).total_cmp(&rms(b)));
    found
}
