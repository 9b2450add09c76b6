//! Projection with derivatives, and starting poses: the parts that OpenCV does.

use nalgebra::DMatrix;
use opencv::calib3d::{self, SolvePnPMethod};
use opencv::core::{Mat, Point2d, Point3d, Vector, no_array};
use opencv::prelude::*;

use super::model::ALL;

/// A pose as OpenCV writes it: rotation vector (radians), translation (mm); board frame to camera frame.
pub type Pose = [f64; 6];

/// What a fit sees of one photo: corners on the board (mm), and in the image (px).
#[derive(Debug, Clone)]
pub struct BoardView {
    pub board_mm: Vec<[f64; 2]>,
    pub seen_px: Vec<[f64; 2]>,
}

impl BoardView {
    /// Every other corner, from `first` on.
    pub fn half(&self, first: usize) -> BoardView {
        let half = |list: &[[f64; 2]]| list.iter().skip(first).step_by(2).copied().collect();
        BoardView {
            board_mm: half(&self.board_mm),
            seen_px: half(&self.seen_px),
        }
    }
}

/// Pixels (2n numbers: x, y of each corner), and their derivatives by the pose (2n × 6) and by the camera (2n × 12).
pub struct Projected {
    pub px: Vec<f64>,
    pub by_pose: DMatrix<f64>,
    pub by_camera: DMatrix<f64>,
}

/// Projects the corners of a view. `None` when OpenCV refuses the numbers or they leave the finite.
pub fn project(board_mm: &[[f64; 2]], camera: &[f64; ALL], pose: &Pose) -> Option<Projected> {
    let points: Vector<Point3d> = board_mm.iter().map(|[x, y]| Point3d::new(*x, *y, 0.0)).collect();
    let (mut px, mut jacobian) = (Vector::<Point2d>::new(), Mat::default());
    let (rvec, tvec) = (column(&pose[..3])?, column(&pose[3..])?);
    let (k, d) = (matrix(camera)?, distortion(camera));
    calib3d::project_points(&points, &rvec, &tvec, &k, &d, &mut px, &mut jacobian, 0.0).ok()?;
    let numbers = jacobian.data_typed::<f64>().ok()?;
    let columns = jacobian.cols() as usize;
    if columns != 6 + ALL || numbers.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let all = DMatrix::from_row_slice(2 * board_mm.len(), columns, numbers);
    Some(Projected {
        px: px.iter().flat_map(|p| [p.x, p.y]).collect(),
        by_pose: all.columns(0, 6).into_owned(),
        by_camera: all.columns(6, ALL).into_owned(),
    })
}

/// The poses that explain a planar view with a camera (both branches of IPPE: Collins & Bartoli 2014), best first.
pub fn starting_poses(view: &BoardView, camera: &[f64; ALL]) -> Vec<Pose> {
    let points: Vector<Point3d> = view.board_mm.iter().map(|[x, y]| Point3d::new(*x, *y, 0.0)).collect();
    let seen: Vector<Point2d> = view.seen_px.iter().map(|[x, y]| Point2d::new(*x, *y)).collect();
    let (mut rvecs, mut tvecs) = (Vector::<Mat>::new(), Vector::<Mat>::new());
    let Some(k) = matrix(camera) else { return Vec::new() };
    let solved = calib3d::solve_pnp_generic(
        &points,
        &seen,
        &k,
        &distortion(camera),
        &mut rvecs,
        &mut tvecs,
        false,
        SolvePnPMethod::SOLVEPNP_IPPE,
        &no_array(),
        &no_array(),
        &mut no_array(),
    );
    if solved.is_err() {
        return Vec::new();
    }
    let pose = |(r, t): (Mat, Mat)| {
        let numbers = [r.data_typed::<f64>().ok()?, t.data_typed::<f64>().ok()?].concat();
        let pose: Pose = numbers.try_into().ok()?;
        pose.iter().all(|v| v.is_finite()).then_some(pose)
    };
    rvecs.iter().zip(tvecs.iter()).filter_map(pose).collect()
}

/// The direction (x, y at depth 1) that a pixel looks in; `None` where the distortion model does not lead back to the pixel.
pub fn direction(camera: &[f64; ALL], [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let seen = Vector::<Point2d>::from_iter([Point2d::new(x, y)]);
    let mut undistorted = Vector::<Point2d>::new();
    let stop = opencv::core::TermCriteria::new(3, 100, 1e-9).ok()?;
    let (k, d) = (matrix(camera)?, distortion(camera));
    calib3d::undistort_points_iter(&seen, &mut undistorted, &k, &d, &no_array(), &no_array(), stop).ok()?;
    let p = undistorted.get(0).ok()?;
    let there = super::model::camera((1, 1), camera).project(&nalgebra::Point3::new(p.x, p.y, 1.0))?;
    ((there[0] - x).hypot(there[1] - y) < 0.05).then_some([p.x, p.y])
}

fn matrix(c: &[f64; ALL]) -> Option<Mat> {
    Mat::from_slice_2d(&[[c[0], 0.0, c[2]], [0.0, c[1], c[3]], [0.0, 0.0, 1.0]]).ok()
}

fn distortion(c: &[f64; ALL]) -> Vector<f64> {
    c[4..].iter().copied().collect()
}

fn column(v: &[f64]) -> Option<Mat> {
    Mat::from_slice_2d(&[[v[0]], [v[1]], [v[2]]]).ok()
}
