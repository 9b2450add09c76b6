//! The ladder of pose solvers, each rung with what the one below lacks. OpenCV solves directly, [`super::refine`] refines.

use nalgebra::Point3;
use opencv::calib3d::{self, SolvePnPMethod};
use opencv::core::{Mat, Point2d, Point3d, Vector, no_array};
use opencv::prelude::*;

use super::matches::{Corners, Match};
use super::refine::{self, NO_BEND};
use crate::camera::Camera;
use crate::geometry::{Rigid, rigid};

/// How a pose is found from matched tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Both planar branches of the largest tag alone (IPPE: Collins & Bartoli 2014), as they come.
    BestTag,
    /// SQPnP over the corners of all tags (Terzakis & Lourakis 2020), as it comes.
    Sqpnp,
    /// SQPnP, then Levenberg–Marquardt over all corners, distortion included.
    SqpnpRefined,
    /// SQPnP and the branches of the largest tags, each refined; tags that the others outvote are left out; single bad corners
    /// weigh less.
    #[default]
    EveryBranch,
}

impl Solver {
    /// Every solver, from the simplest to the default.
    pub fn all() -> [Solver; 4] {
        [
            Solver::BestTag,
            Solver::Sqpnp,
            Solver::SqpnpRefined,
            Solver::EveryBranch,
        ]
    }

    /// A stable name for tables and programs.
    pub fn name(self) -> &'static str {
        match self {
            Solver::BestTag => "ippe_best_tag",
            Solver::Sqpnp => "sqpnp",
            Solver::SqpnpRefined => "sqpnp_lm",
            Solver::EveryBranch => "every_branch_lm",
        }
    }

    /// The matches this solver looks at.
    pub(super) fn used<'a>(self, mut matches: Vec<Match<'a>>) -> Vec<Match<'a>> {
        if self == Solver::BestTag {
            largest_first(&mut matches);
            matches.truncate(1);
        }
        matches
    }

    /// Every pose that might be the one, unsorted.
    pub(super) fn candidates(self, matches: &[Match], camera: &Camera) -> Vec<Candidate> {
        let corners = Corners::of(matches);
        let refined = |starts: Vec<Rigid>| {
            let refined = |start| refine::refine(start, &corners, camera, NO_BEND);
            starts.iter().filter_map(refined).collect()
        };
        let poses: Vec<Rigid> = match self {
            Solver::BestTag => branches(matches, camera),
            Solver::Sqpnp => sqpnp(&corners, camera),
            Solver::SqpnpRefined => refined(sqpnp(&corners, camera)),
            Solver::EveryBranch => {
                let mut starts = sqpnp(&corners, camera);
                starts.extend(branches(matches, camera));
                refined(starts)
            }
        };
        let with_rms = |pose| {
            Some(Candidate {
                rms_px: refine::rms_px(&pose, &corners, camera)?,
                pose,
            })
        };
        poses.into_iter().filter_map(with_rms).collect()
    }
}

/// A pose and how far it leaves the corners from where they were seen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub pose: Rigid,
    pub rms_px: f64,
}

/// So many of the largest tags give their planar branches as starts; smaller ones add time and no new pose.
const BRANCHED_TAGS: usize = 3;

/// `T_camera_model` by SQPnP over all corners.
fn sqpnp(corners: &Corners, camera: &Camera) -> Vec<Rigid> {
    solve(
        &corners.model_mm,
        &corners.image_px,
        camera,
        SolvePnPMethod::SOLVEPNP_SQPNP,
    )
}

/// `T_camera_model` by both planar branches of each of the largest tags.
fn branches(matches: &[Match], camera: &Camera) -> Vec<Rigid> {
    let mut largest = matches.to_vec();
    largest_first(&mut largest);
    let of = |m: &Match| {
        let to_model = m.tag.pose().inverse();
        let branches = planar_branches(&m.tag.corners_in_tag_mm(), &m.corners_px, camera);
        branches.into_iter().map(move |t_camera_tag| t_camera_tag * to_model)
    };
    largest.iter().take(BRANCHED_TAGS).flat_map(of).collect()
}

/// `T_camera_tag` of a square's two planar branches (IPPE: Collins & Bartoli 2014); none when OpenCV gives up. `in_tag_mm`: its corners in its
/// own frame, top-left first.
pub fn planar_branches(in_tag_mm: &[Point3<f64>; 4], corners_px: &[[f64; 2]; 4], camera: &Camera) -> Vec<Rigid> {
    solve(in_tag_mm, corners_px, camera, SolvePnPMethod::SOLVEPNP_IPPE_SQUARE)
}

pub(super) fn largest_first(matches: &mut [Match]) {
    matches.sort_by(|a, b| b.area_px().total_cmp(&a.area_px()));
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
