//! One moved card among several whole ones: which tags agree, and what is wrong with the others.
//!
//! A tag's four corners stand or fall together. A pose is found from the tags that agree only when these are at least three and
//! more than half; two tags that disagree are never chosen between.

use nalgebra::{Matrix6, SMatrix, SVector};

use super::doubt::{self, Abstention};
use super::matches::{Corners, Ignored, IgnoredTag, Match};
use super::refine::{self, NO_BEND};
use super::reprojection::pixel_by_pose;
use super::solver::{Candidate, Solver, largest_first};
use super::uncertainty::pooled;
use crate::camera::Camera;
use crate::geometry::Rigid;
use crate::scene::{Scene, Tag};

/// Squared distance of a tag's eight coordinates from where the other tags expect them, in units of the noise, beyond which it
/// does not agree: 3.5 σ for each. Were the noise normal and known, 1 honest tag in 10¹⁷ would be beyond it; real corners have
/// tails.
const AGREES: f64 = 8.0 * 3.5 * 3.5;

/// Noise that is believed at most, as an angle: with more, several moved tags would excuse each other.
const MAX_NOISE_DEG: f64 = 0.05;

/// Pairs of so many of the largest tags are asked what they see.
const ASKED_TAGS: usize = 8;

/// A majority is at least so many tags.
const MIN_AGREEING: usize = 3;

/// The tags that agree, the poses that might be theirs, and the tags left out.
pub(super) struct Consensus<'a> {
    pub matches: Vec<Match<'a>>,
    pub candidates: Vec<Candidate>,
    pub left_out: Vec<IgnoredTag>,
}

/// All tags where they agree, else the majority that does.
pub(super) fn find<'a>(matches: Vec<Match<'a>>, scene: &Scene, camera: &Camera) -> Result<Consensus<'a>, Abstention> {
    let candidates = Solver::EveryBranch.candidates(&matches, camera);
    if matches.len() < MIN_AGREEING || best(&candidates).is_some_and(|b| all_agree(&b.pose, &matches, camera)) {
        return Ok(Consensus {
            matches,
            candidates,
            left_out: Vec::new(),
        });
    }
    let tags = matches.len();
    let (pose, kept) = majority(&matches, camera).ok_or(Abstention::NoMajority { tags })?;
    let (matches, outvoted): (Vec<_>, Vec<_>) = matches.into_iter().zip(&kept).partition(|(_, is_kept)| **is_kept);
    let matches: Vec<Match> = matches.into_iter().map(|(m, _)| m).collect();
    let why = |m: &Match| blame(m, &pose, scene, camera);
    Ok(Consensus {
        candidates: Solver::EveryBranch.candidates(&matches, camera),
        matches,
        left_out: outvoted
            .iter()
            .map(|(m, _)| IgnoredTag {
                id: m.tag.id,
                why: why(m),
            })
            .collect(),
    })
}

fn best(candidates: &[Candidate]) -> Option<&Candidate> {
    candidates.iter().min_by(|a, b| a.rms_px.total_cmp(&b.rms_px))
}

/// The pose that a majority of tags agrees on, and which do. `None` without a majority, and with two of them.
fn majority(matches: &[Match], camera: &Camera) -> Option<(Rigid, Vec<bool>)> {
    let is_majority = |kept: &[bool]| {
        let count = kept.iter().filter(|k| **k).count();
        count >= MIN_AGREEING && 2 * count > kept.len()
    };
    let mut largest = matches.to_vec();
    largest_first(&mut largest);
    largest.truncate(ASKED_TAGS);
    let mut found: Vec<(Rigid, Vec<bool>)> = Vec::new();
    for (i, one) in largest.iter().enumerate() {
        for other in &largest[i + 1..] {
            let pair = [one.clone(), other.clone()];
            for candidate in Solver::EveryBranch.candidates(&pair, camera) {
                if candidate.rms_px > doubt::limit_px(camera) {
                    continue;
                }
                let Some(kept) = agreeing_with(&candidate.pose, &pair, matches, camera) else {
                    continue;
                };
                if is_majority(&kept) {
                    found.extend(settle(candidate.pose, kept, matches, camera).filter(|(_, kept)| is_majority(kept)));
                }
            }
        }
    }
    let (pose, kept) = found
        .iter()
        .max_by_key(|(_, kept)| kept.iter().filter(|k| **k).count())?;
    let has_rival = found.iter().any(|(other, _)| doubt::is_different(other, pose));
    (!has_rival).then(|| (*pose, kept.clone()))
}

/// Fits the tags that agree and asks again who does, until the answer stays.
fn settle(mut pose: Rigid, mut kept: Vec<bool>, matches: &[Match], camera: &Camera) -> Option<(Rigid, Vec<bool>)> {
    for _ in 0..5 {
        let members: Vec<Match> = chosen(matches, &kept);
        pose = refine::refine(&pose, &Corners::of(&members), camera, NO_BEND)?;
        let now = agreeing_with(&pose, &members, matches, camera)?;
        if now == kept {
            return all_agree(&pose, &members, camera).then_some((pose, kept));
        }
        kept = now;
    }
    None
}

fn chosen<'a>(matches: &[Match<'a>], kept: &[bool]) -> Vec<Match<'a>> {
    let chosen = matches.iter().zip(kept).filter(|(_, is_kept)| **is_kept);
    chosen.map(|(m, _)| m.clone()).collect()
}

/// Whether each tag lies where the others expect it, by the residuals of the fit to all: deleted residuals (Cook & Weisberg 1982,
/// "Residuals and Influence in Regression", section 3.2) of a tag's eight coordinates.
fn all_agree(pose: &Rigid, matches: &[Match], camera: &Camera) -> bool {
    let Some(seen) = Linear::of_all(pose, matches, camera) else {
        return false;
    };
    let Some(covariance) = total(&seen) else { return false };
    let squares: f64 = seen.iter().map(|l| l.residual.norm_squared()).sum();
    let freedom = 8.0 * (seen.len() as f64 - 1.0) - 6.0;
    seen.iter().all(|l| {
        let kept = SMatrix::<f64, 8, 8>::identity() - l.slope * covariance * l.slope.transpose();
        let deleted = kept.cholesky().map(|c| l.residual.dot(&c.solve(&l.residual)));
        deleted.is_some_and(|d| d <= AGREES * variance_px2(squares - d, freedom, camera))
    })
}

/// Which tags lie where a pose, fitted to some of them, expects them. Those it was fitted to agree when their own residual is
/// within the noise.
fn agreeing_with(pose: &Rigid, fitted: &[Match], matches: &[Match], camera: &Camera) -> Option<Vec<bool>> {
    let members = Linear::of_all(pose, fitted, camera)?;
    let covariance = total(&members)?;
    let squares: f64 = members.iter().map(|l| l.residual.norm_squared()).sum();
    let variance_px2 = variance_px2(squares, 8.0 * members.len() as f64 - 6.0, camera);
    let agrees = |m: &Match| {
        let Some(l) = Linear::of(pose, m, camera) else {
            return false;
        };
        let is_member = fitted.iter().any(|f| std::ptr::eq(f.tag, m.tag));
        let mut expected = SMatrix::<f64, 8, 8>::identity();
        if !is_member {
            expected += l.slope * covariance * l.slope.transpose();
        }
        expected
            .cholesky()
            .is_some_and(|c| l.residual.dot(&c.solve(&l.residual)) <= AGREES * variance_px2)
    };
    Some(matches.iter().map(agrees).collect())
}

/// The variance of the corner noise, px² per axis, never more than is believed.
fn variance_px2(squares: f64, freedom: f64, camera: &Camera) -> f64 {
    let most = (MAX_NOISE_DEG / camera.deg_per_px()).powi(2);
    pooled(squares.max(0.0), freedom).min(most)
}

/// The eight coordinates of a tag near a pose: residuals, and their derivatives by a step of the pose.
struct Linear {
    residual: SVector<f64, 8>,
    slope: SMatrix<f64, 8, 6>,
}

impl Linear {
    fn of(pose: &Rigid, m: &Match, camera: &Camera) -> Option<Linear> {
        let (mut residual, mut slope) = (SVector::<f64, 8>::zeros(), SMatrix::<f64, 8, 6>::zeros());
        for (i, (point, [u, v])) in m.tag.corners_mm().iter().zip(m.corners_px).enumerate() {
            let ([x, y], by_pose) = pixel_by_pose(camera, pose, point)?;
            (residual[2 * i], residual[2 * i + 1]) = (x - u, y - v);
            slope.fixed_view_mut::<2, 6>(2 * i, 0).copy_from(&by_pose);
        }
        residual
            .iter()
            .all(|r: &f64| r.is_finite())
            .then_some(Linear { residual, slope })
    }

    fn of_all(pose: &Rigid, matches: &[Match], camera: &Camera) -> Option<Vec<Linear>> {
        matches.iter().map(|m| Linear::of(pose, m, camera)).collect()
    }
}

/// (JᵀJ)⁻¹ over some tags.
fn total(seen: &[Linear]) -> Option<Matrix6<f64>> {
    let information: Matrix6<f64> = seen.iter().map(|l| l.slope.transpose() * l.slope).sum();
    Some(information.cholesky()?.inverse())
}

/// What is wrong with an outvoted tag, by the pose of the others.
fn blame(m: &Match, pose: &Rigid, scene: &Scene, camera: &Camera) -> Ignored {
    let limit_px = doubt::limit_px(camera);
    let expected =
        |tag: &Tag| -> Option<Vec<[f64; 2]>> { tag.corners_mm().iter().map(|p| camera.project(&(pose * p))).collect() };
    // How many corners are where they are expected, when seen corner `i` is really corner `order(i)`.
    let fitting = |tag: &Tag, order: &dyn Fn(usize) -> usize| {
        let Some(expected) = expected(tag) else { return 0 };
        let is_near = |i: &usize| {
            let ([x, y], [u, v]) = (expected[order(*i) % 4], m.corners_px[*i]);
            (x - u).hypot(y - v) <= limit_px
        };
        (0..4).filter(is_near).count()
    };
    let others = scene
        .tags
        .iter()
        .filter(|t| (t.family, t.id) != (m.tag.family, m.tag.id));
    if (1..4).any(|by| fitting(m.tag, &|i| i + by) == 4) {
        Ignored::Turned
    } else if (0..4).any(|from| fitting(m.tag, &|i| from + 4 - i) == 4) {
        Ignored::Mirrored
    } else if others.into_iter().any(|other| fitting(other, &|i| i) == 4) {
        Ignored::WrongId
    } else if fitting(m.tag, &|i| i) == 3 {
        Ignored::CornerOff
    } else {
        Ignored::Moved
    }
}
