//! Pose solvers, from the simplest to the default, each adding to the one before: [`super::planar`] and [`super::sqpnp`] solve directly,
//! [`super::refine`] refines.

use super::matches::{Corners, Match};
use super::planar::planar_branches;
use super::refine::{self, NO_HUBER};
use super::sqpnp::sqpnp;
use crate::camera::Camera;
use crate::scene::corners_in_tag_mm;
use scaleproof_core::geometry::Rigid;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Both planar branches of the largest tag alone (IPPE: Collins & Bartoli 2014), unrefined.
    BestTag,
    /// SQPnP over the corners of all tags (Terzakis & Lourakis 2020), unrefined.
    Sqpnp,
    /// SQPnP, then Levenberg–Marquardt over all corners, distortion included.
    SqpnpRefined,
    /// SQPnP and the branches of the largest tags, each refined; outlier tags are left out; single bad corners
    /// weigh less.
    #[default]
    EveryBranch,
}

impl Solver {
    /// Returns every solver, from the simplest to the default.
    pub fn all() -> [Solver; 4] {
        use Solver::*;
        [BestTag, Sqpnp, SqpnpRefined, EveryBranch]
    }

    pub fn name(self) -> &'static str {
        match self {
            Solver::BestTag => "ippe_best_tag",
            Solver::Sqpnp => "sqpnp",
            Solver::SqpnpRefined => "sqpnp_lm",
            Solver::EveryBranch => "every_branch_lm",
        }
    }

    pub(super) fn used<'a>(self, matches: Vec<Match<'a>>) -> Vec<Match<'a>> {
        match self {
            Solver::BestTag => largest(&matches, 1),
            _ => matches,
        }
    }

    /// Returns all candidate poses, unsorted.
    pub(super) fn candidates(self, matches: &[Match], camera: &Camera) -> Vec<PoseCandidate> {
        let corners = Corners::new(matches);
        let refined = |starts: Vec<Rigid>| {
            let refined = |start| refine::refine(start, &corners, camera, NO_HUBER);
            starts.iter().filter_map(refined).collect()
        };
        let of_all = || sqpnp(&corners.model_mm, &corners.image_px, camera).into_iter();
        let poses: Vec<Rigid> = match self {
            Solver::BestTag => branches(matches, camera),
            Solver::Sqpnp => of_all().collect(),
            Solver::SqpnpRefined => refined(of_all().collect()),
            Solver::EveryBranch => refined(of_all().chain(branches(matches, camera)).collect()),
        };
        let with_rms = |pose| {
            Some(PoseCandidate {
                rms_px: refine::rms_px(&pose, &corners, camera)?,
                pose,
            })
        };
        poses.into_iter().filter_map(with_rms).collect()
    }
}

/// Candidate pose and its root mean square residual.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseCandidate {
    pub pose: Rigid,
    pub rms_px: f64,
}

/// Number of the largest tags whose planar branches are used as starts; smaller ones add time and no new pose.
const BRANCHED_TAGS: usize = 3;

/// Returns `T_camera_model` by both planar branches of each of the largest tags.
fn branches(matches: &[Match], camera: &Camera) -> Vec<Rigid> {
    let branches = |m: Match| {
        let to_model = m.tag.pose().inverse();
        let branches = planar_branches(&corners_in_tag_mm(m.tag.size_mm), &m.corners_px, camera);
        branches.into_iter().map(move |t_camera_tag| t_camera_tag * to_model)
    };
    largest(matches, BRANCHED_TAGS).into_iter().flat_map(branches).collect()
}

pub(super) fn largest<'a>(matches: &[Match<'a>], most: usize) -> Vec<Match<'a>> {
    let mut largest = matches.to_vec();
    largest.sort_by(|a, b| b.area_px().total_cmp(&a.area_px()));
    largest.truncate(most);
    largest
}
