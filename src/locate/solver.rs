//! OpenCV's pose solvers: starts from SQPnP and IPPE, refinement by Levenberg–Marquardt.

use nalgebra::Point3;
use opencv::calib3d::{self, SolvePnPMethod};
use opencv::core::{Mat, Point2d, Point3d, TermCriteria, TermCriteria_Type, Vector, no_array};
use opencv::prelude::*;

use super::{Corners, Match};
use crate::camera::Camera;
use crate::geometry::{Rigid, rigid};

/// So many of the largest tags give their planar branches as starts; smaller ones add time and no new pose.
const BRANCHED_TAGS: usize = 3;

/// Every pose worth refining: `T_camera_model`.
pub(super) fn starts(matches: &[Match], corners: &Corners, camera: &Camera) -> Vec<Rigid> {
    let mut starts = solve(
        &corners.model_mm,
        &corners.image_px,
        camera,
        SolvePnPMethod::SOLVEPNP_SQPNP,
    );
    let mut largest: Vec<&Match> = matches.iter().collect();
    largest.sort_by(|a, b| b.area_px().total_cmp(&a.area_px()));
    for m in largest.into_iter().take(BRANCHED_TAGS) {
        let in_tag = m.tag.corners_in_tag_mm();
        let branches = solve(&in_tag, &m.corners_px, camera, SolvePnPMethod::SOLVEPNP_IPPE_SQUARE);
        starts.extend(
            branches
                .into_iter()
                .map(|t_camera_tag| t_camera_tag * m.tag.pose().inverse()),
        );
    }
    starts
}

/// Levenberg–Marquardt over all corners, distortion included. `None` when it runs away.
pub(super) fn refine(start: &Rigid, corners: &Corners, camera: &Camera) -> Option<Rigid> {
    let (rvec, tvec) = rigid::to_rotation_vector(start);
    let (mut rvec, mut tvec) = (column(&rvec)?, column(&tvec)?);
    let criteria = TermCriteria {
        typ: TermCriteria_Type::EPS as i32 + TermCriteria_Type::COUNT as i32,
        max_count: 50,
        epsilon: 1e-10,
    };
    let (model, image) = (model_points(&corners.model_mm), image_points(&corners.image_px));
    let (k, d) = (matrix(camera)?, distortion(camera));
    calib3d::solve_pnp_refine_lm(&model, &image, &k, &d, &mut rvec, &mut tvec, criteria).ok()?;
    pose(&rvec, &tvec)
}

/// All solutions of one of OpenCV's direct solvers; none when it gives up.
fn solve(model_mm: &[Point3<f64>], image_px: &[[f64; 2]], camera: &Camera, method: SolvePnPMethod) -> Vec<Rigid> {
    let (mut rvecs, mut tvecs) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    let (model, image) = (model_points(model_mm), image_points(image_px));
    let Some(k) = matrix(camera) else { return Vec::new() };
    let solved = calib3d::solve_pnp_generic(
        &model,
        &image,
        &k,
        &distortion(camera),
        &mut rvecs,
        &mut tvecs,
        false,
        method,
        &no_array(),
        &no_array(),
        &mut no_array(),
    );
    match solved {
        Ok(_) => rvecs
            .iter()
            .zip(tvecs.iter())
            .filter_map(|(r, t)| pose(&r, &t))
            .collect(),
        Err(_) => Vec::new(),
    }
}

fn model_points(points: &[Point3<f64>]) -> Vector<Point3d> {
    points.iter().map(|p| Point3d::new(p.x, p.y, p.z)).collect()
}

fn image_points(points: &[[f64; 2]]) -> Vector<Point2d> {
    points.iter().map(|[x, y]| Point2d::new(*x, *y)).collect()
}

fn matrix(c: &Camera) -> Option<Mat> {
    Mat::from_slice_2d(&[[c.fx, 0.0, c.cx], [0.0, c.fy, c.cy], [0.0, 0.0, 1.0]]).ok()
}

fn distortion(c: &Camera) -> Vector<f64> {
    c.distortion().iter().copied().collect()
}

fn column(v: &[f64; 3]) -> Option<Mat> {
    Mat::from_slice_2d(&[[v[0]], [v[1]], [v[2]]]).ok()
}

/// Rotation vector and translation as a transform; `None` when the solver returned numbers that are not finite.
fn pose(rvec: &Mat, tvec: &Mat) -> Option<Rigid> {
    let (r, t) = (triple(rvec)?, triple(tvec)?);
    r.iter()
        .chain(&t)
        .all(|v| v.is_finite())
        .then(|| rigid::from_rotation_vector(r, t))
}

fn triple(m: &Mat) -> Option<[f64; 3]> {
    m.data_typed::<f64>().ok()?.try_into().ok()
}
