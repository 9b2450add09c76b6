//! The two poses that explain a square's four corners almost equally well.

use nalgebra::Point3;
use opencv::calib3d::{self, SolvePnPMethod};
use opencv::core::{Mat, Point2d, Point3d, Vector, no_array};
use opencv::prelude::*;

use super::residual::{corners_mm, rms_px};
use crate::camera::Camera;
use crate::geometry::{Rigid, rigid};

/// Both branches, `T_camera_tag`, the better first (IPPE: Collins & Bartoli 2014, by OpenCV); none when OpenCV gives up.
pub(super) fn branches(size_mm: f64, corners_px: &[[f64; 2]; 4], camera: &Camera) -> Vec<Rigid> {
    let mut found = solve(size_mm, corners_px, camera).unwrap_or_default();
    let rms = |pose: &Rigid| rms_px(pose, size_mm, corners_px, camera);
    found.retain(|pose| pose.translation.z > 0.0 && rms(pose) < 100.0);
    found.sort_by(|a, b| rms(a).total_cmp(&rms(b)));
    found
}

fn solve(size_mm: f64, corners_px: &[[f64; 2]; 4], c: &Camera) -> opencv::Result<Vec<Rigid>> {
    let point = |p: &Point3<f64>| Point3d::new(p.x, p.y, p.z);
    let square: Vector<Point3d> = corners_mm(size_mm).iter().map(point).collect();
    let image: Vector<Point2d> = corners_px.iter().map(|[x, y]| Point2d::new(*x, *y)).collect();
    let k = Mat::from_slice_2d(&[[c.fx, 0.0, c.cx], [0.0, c.fy, c.cy], [0.0, 0.0, 1.0]])?;
    let distortion: Vector<f64> = c.distortion().iter().copied().collect();
    let (mut rvecs, mut tvecs) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    calib3d::solve_pnp_generic(
        &square,
        &image,
        &k,
        &distortion,
        &mut rvecs,
        &mut tvecs,
        false,
        SolvePnPMethod::SOLVEPNP_IPPE_SQUARE,
        &no_array(),
        &no_array(),
        &mut no_array(),
    )?;
    let triple = |m: &Mat| -> Option<[f64; 3]> { m.data_typed::<f64>().ok()?.try_into().ok() };
    let pose = |(r, t): (Mat, Mat)| Some(rigid::from_rotation_vector(triple(&r)?, triple(&t)?));
    let found = rvecs.iter().zip(tvecs.iter()).filter_map(pose);
    Ok(found
        .filter(|p| p.to_homogeneous().iter().all(|v| v.is_finite()))
        .collect())
}
