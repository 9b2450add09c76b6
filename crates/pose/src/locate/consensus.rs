//! Outlier rejection: the largest consistent set of tags, and diagnoses of the rejected ones.
//!
//! The four corners of a tag are accepted or rejected together. A pose is computed from the inlier tags only if these are at least three and two
//! thirds of all; of two tags that disagree none is chosen.

use nalgebra::{Matrix6, SMatrix, SVector};

use super::abstention::Abstention;
use super::doubt;
use super::matches::{Corners, Ignored, IgnoredTag, Match};
use super::refine::{self, NO_HUBER};
use super::solver::{PoseCandidate, Solver, largest};
use super::uncertainty::pooled;
use crate::camera::Camera;
use crate::scene::{Scene, Tag};
use scaleproof_core::geometry::Rigid;

/// Squared distance of a tag's eight coordinates from their prediction by the other tags, in units of the noise, beyond which the tag is an outlier:
/// 3.5 σ for each. Normal noise does not come near it; real corners have tails.
const AGREES: f64 = 8.0 * 3.5 * 3.5;

/// Upper bound of the estimated noise, as an angle: with more, several moved tags would mask each other.
pub(super) const MAX_NOISE_DEG: f64 = 0.05;

/// Number of the largest tags that are paired to find a majority that agrees with a pair.
const ASKED_TAGS: usize = 8;

/// Minimum number of tags in a majority.
const MIN_AGREEING: usize = 3;

/// Inlier tags, their candidate poses, and the rejected tags.
pub(super) struct Consensus<'a> {
    pub matches: Vec<Match<'a>>,
    pub candidates: Vec<PoseCandidate>,
    pub left_out: Vec<IgnoredTag>,
}

impl<'a> Consensus<'a> {
    /// Returns all tags as inliers, without a test.
    pub(super) fn unchecked(solver: Solver, matches: Vec<Match<'a>>, camera: &Camera) -> Consensus<'a> {
        Consensus {
            candidates: solver.candidates(&matches, camera),
            matches,
            left_out: Vec::new(),
        }
    }
}

/// Returns all tags if they agree, else the majority that does.
pub(super) fn find<'a>(matches: Vec<Match<'a>>, scene: &Scene, camera: &Camera) -> Result<Consensus<'a>, Abstention> {
    let mut all = Consensus::unchecked(Solver::EveryBranch, matches, camera);
    let best = all.candidates.iter().min_by(|a, b| a.rms_px.total_cmp(&b.rms_px));
    let agree = |b: &PoseCandidate| Some(disagreement(&b.pose, &all.matches, camera)?.iter().all(|d| *d <= 1.0));
    let tags = all.matches.len();
    if tags < MIN_AGREEING || best.and_then(agree) == Some(true) {
        return Ok(all);
    }
    let Majority { pose, members } = majority(best, &all.matches, camera).ok_or(Abstention::NoMajority { tags })?;
    all.matches.retain(|m| !members.iter().any(|member| is_same(m, member)));
    let left_out = all.matches.iter().map(|m| IgnoredTag {
        id: m.tag.id,
        why: diagnose_outlier(m, &pose, scene, camera),
    });
    Ok(Consensus {
        left_out: left_out.collect(),
        ..Consensus::unchecked(Solver::EveryBranch, members, camera)
    })
}

/// Pose of a majority of tags, and these tags.
struct Majority<'a> {
    pose: Rigid,
    members: Vec<Match<'a>>,
}

/// Finds the pose on which a majority of tags agrees. `None` if there is no majority, or more than one.
///
/// One or two moved tags show up in the fit to all; with more, some pair of correct tags is free of their influence.
fn majority<'a>(start: Option<&PoseCandidate>, matches: &[Match<'a>], camera: &Camera) -> Option<Majority<'a>> {
    if let Some(found) = start.and_then(|s| settle(s.pose, matches.to_vec(), matches.len(), camera)) {
        return Some(found);
    }
    let largest = largest(matches, ASKED_TAGS);
    let mut found: Vec<Majority> = Vec::new();
    for (i, one) in largest.iter().enumerate() {
        for other in &largest[i + 1..] {
            let pair = [one.clone(), other.clone()];
            let has = |members: &[Match], p| members.iter().any(|m| is_same(m, p));
            if !found.iter().any(|found| pair.iter().all(|p| has(&found.members, p))) {
                found.extend(majority_by(&pair, matches, camera));
            }
        }
    }
    let best = (0..found.len()).max_by_key(|i| found[*i].members.len())?;
    let has_rival = found
        .iter()
        .any(|other| doubt::is_different(&other.pose, &found[best].pose));
    (!has_rival).then(|| found.swap_remove(best))
}

/// Returns the majorities that agree with the candidate poses of a pair.
fn majority_by<'a>(pair: &[Match], matches: &[Match<'a>], camera: &Camera) -> Vec<Majority<'a>> {
    let by = |candidate: &PoseCandidate| {
        let members = expected_by(&candidate.pose, pair, matches, camera)?;
        settle(candidate.pose, members, matches.len(), camera)
    };
    let candidates = Solver::EveryBranch.candidates(pair, camera);
    let fitting = candidates.iter().filter(|c| c.rms_px <= doubt::limit_px(camera));
    fitting.filter_map(by).collect()
}

fn is_same(a: &Match, b: &Match) -> bool {
    std::ptr::eq(a.tag, b.tag)
}

/// Fits the members and drops the one that agrees least with the others, until all agree. `None` when fewer than three, or than two thirds of all
/// tags, are left: otherwise tags that a wrong camera or scene file puts at odds would be dropped until the rest agrees on a wrong pose.
fn settle<'a>(mut pose: Rigid, mut members: Vec<Match<'a>>, all: usize, camera: &Camera) -> Option<Majority<'a>> {
    while members.len() >= MIN_AGREEING && 3 * members.len() >= 2 * all {
        pose = refine::refine(&pose, &Corners::new(&members), camera, NO_HUBER)?;
        let disagreement = disagreement(&pose, &members, camera)?;
        let worst = (0..members.len()).max_by(|a, b| disagreement[*a].total_cmp(&disagreement[*b]))?;
        if disagreement[worst] <= 1.0 {
            return Some(Majority { pose, members });
        }
        members.remove(worst);
    }
    None
}

/// Returns each tag's squared distance from its prediction by the other tags, relative to the allowed one, by deleted residuals (Cook & Weisberg
/// 1982, "Residuals and Influence in Regression", section 3.2) of its eight coordinates in the fit to all.
fn disagreement(pose: &Rigid, matches: &[Match], camera: &Camera) -> Option<Vec<f64>> {
    let (seen, covariance, squares) = linearised(pose, matches, camera)?;
    let freedom = 8.0 * (seen.len() as f64 - 1.0) - 6.0;
    let distance = |l: &LinearisedTag| {
        let kept = SMatrix::<f64, 8, 8>::identity() - l.jacobian * covariance * l.jacobian.transpose();
        // A tag that the others do not predict cannot be tested: it counts as an outlier.
        kept.cholesky().map_or(f64::INFINITY, |c| {
            let deleted = l.residual.dot(&c.solve(&l.residual));
            deleted / allowed_px2(squares - deleted, freedom, camera)
        })
    };
    Some(seen.iter().map(distance).collect())
}

/// Returns the tags that lie where a pose, fitted to `fitted`, predicts them.
fn expected_by<'a>(pose: &Rigid, fitted: &[Match], matches: &[Match<'a>], camera: &Camera) -> Option<Vec<Match<'a>>> {
    let (members, covariance, squares) = linearised(pose, fitted, camera)?;
    let allowed_px2 = allowed_px2(squares, 8.0 * members.len() as f64 - 6.0, camera);
    let agrees = |m: &&Match| {
        let is_member = fitted.iter().any(|f| is_same(f, m));
        let Some(l) = LinearisedTag::new(pose, m, camera) else {
            return false;
        };
        let expected = SMatrix::<f64, 8, 8>::identity() + l.jacobian * covariance * l.jacobian.transpose();
        let square = expected.cholesky().map(|c| l.residual.dot(&c.solve(&l.residual)));
        is_member || square.is_some_and(|square| square <= allowed_px2)
    };
    Some(matches.iter().filter(agrees).cloned().collect())
}

/// Returns the largest squared distance of an inlier tag, px², from the squared residuals of the others and their degrees of freedom.
fn allowed_px2(squares: f64, freedom: f64, camera: &Camera) -> f64 {
    let most = (MAX_NOISE_DEG / camera.deg_per_px()).powi(2);
    // With fewer other tags the noise is known less well.
    AGREES * (1.0 + 8.0 / freedom) * pooled(squares.max(0.0), freedom).min(most)
}

/// Residuals of a tag's eight coordinates at a pose, and their derivatives by a step of the pose.
struct LinearisedTag {
    residual: SVector<f64, 8>,
    jacobian: SMatrix<f64, 8, 6>,
}

impl LinearisedTag {
    fn new(pose: &Rigid, m: &Match, camera: &Camera) -> Option<LinearisedTag> {
        let (mut residual, mut jacobian) = (SVector::<f64, 8>::zeros(), SMatrix::<f64, 8, 6>::zeros());
        for (i, (point, [u, v])) in m.tag.corners_mm().iter().zip(m.corners_px).enumerate() {
            let ([x, y], by_pose) = camera.project_by_pose(pose, point)?;
            (residual[2 * i], residual[2 * i + 1]) = (x - u, y - v);
            jacobian.fixed_view_mut::<2, 6>(2 * i, 0).copy_from(&by_pose);
        }
        let is_finite = residual.iter().all(|r: &f64| r.is_finite());
        is_finite.then_some(LinearisedTag { residual, jacobian })
    }
}

/// Linearises tags at a pose; returns them, (JᵀJ)⁻¹ over them, and the sum of their squared residuals, px².
fn linearised(pose: &Rigid, matches: &[Match], camera: &Camera) -> Option<(Vec<LinearisedTag>, Matrix6<f64>, f64)> {
    let seen = matches.iter().map(|m| LinearisedTag::new(pose, m, camera));
    let seen = seen.collect::<Option<Vec<_>>>()?;
    let information: Matrix6<f64> = seen.iter().map(|l| l.jacobian.transpose() * l.jacobian).sum();
    let squares = seen.iter().map(|l| l.residual.norm_squared()).sum();
    Some((seen, information.cholesky()?.inverse(), squares))
}

/// Diagnoses an outlier tag, by the pose of the inliers.
fn diagnose_outlier(m: &Match, pose: &Rigid, scene: &Scene, camera: &Camera) -> Ignored {
    let limit_px = doubt::limit_px(camera);
    // Counts the corners that are where they are expected, if seen corner `i` is really corner `order(i)`.
    let fitting = |tag: &Tag, order: &dyn Fn(usize) -> usize| {
        let Some(expected) = tag.corners_px(pose, camera) else {
            return 0;
        };
        let is_near = |i: &usize| {
            let ([x, y], [u, v]) = (expected[order(*i) % 4], m.corners_px[*i]);
            (x - u).hypot(y - v) <= limit_px
        };
        (0..4).filter(is_near).count()
    };
    let is_other = |tag: &&Tag| (tag.family, tag.id) != (m.tag.family, m.tag.id);
    let mut others = scene.tags.iter().filter(is_other);
    if (1..4).any(|by| fitting(m.tag, &|i| i + by) == 4) {
        Ignored::Turned
    } else if (0..4).any(|from| fitting(m.tag, &|i| from + 4 - i) == 4) {
        Ignored::Mirrored
    } else if others.any(|other| fitting(other, &|i| i) == 4) {
        Ignored::WrongId
    } else if fitting(m.tag, &|i| i) >= 3 {
        Ignored::CornerOff
    } else {
        Ignored::Moved
    }
}

/// Returns true if a pose's tags fit worse than a camera's noise explains. `rms_px` refers to the camera's own image size.
pub fn is_poor_fit(rms_px: f64, camera: &Camera) -> bool {
    rms_px * camera.deg_per_px() > MAX_NOISE_DEG
}
