//! A camera fitted again, to photos of points whose places are known.

use super::fit;
use super::model::{ALL, LensModel};
use super::view::View;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;

/// The camera that explains the views best, in least squares, with the poses free: of a model, from a start, whose other numbers stay. What is seen is in the frame of the
/// camera's image. `poses`: `T_camera_points` of each view, about. `None` where the fit finds none.
pub fn refit(model: LensModel, start: &Camera, views: &[View], poses: Vec<Rigid>) -> Option<Camera> {
    let mut numbers = [0.0; ALL];
    numbers[..4].copy_from_slice(&[start.fx, start.fy, start.cx, start.cy]);
    numbers[4..].copy_from_slice(start.distortion());
    let [fx, fy, cx, cy, distortion @ ..] = fit::fit(model, views, numbers, poses)?.camera;
    let mut found = start.clone().with_distortion(&distortion);
    (found.fx, found.fy, found.cx, found.cy) = (fx, fy, cx, cy);
    found.sigma_px = None;
    Some(found)
}
