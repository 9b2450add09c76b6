//! Which tags of a scene a photo should show besides those that were found: for a search that stops when nothing is missing.

use super::abstention::Abstention;
use super::plain_view;
use super::solver::Solver;
use super::{Located, Warning, doubt, matches};
use crate::camera::Camera;
use crate::scene::Scene;
use crate::tags::{ExpectedTag, SeenTag, StillMissing};
use scaleproof_core::geometry::Rigid;

/// Without a pose, so many of the poses that the tags allow are believed for the time of a look.
const MOST_POSES: usize = 4;

/// What is still missing, by the pose found so far or, without one, by those the tags allow; without any tag, by a guess.
pub(super) fn still_missing(
    located: &Result<Located, Abstention>,
    guess: Option<&Rigid>,
    seen: &[SeenTag],
    scene: &Scene,
    camera: &Camera,
) -> StillMissing {
    let poses = match located {
        Ok(located) => vec![located.pose],
        Err(_) if seen.is_empty() => guess.copied().into_iter().collect(),
        Err(_) => allowed(seen, scene, camera),
    };
    let is_seen = |expected: &ExpectedTag| seen.iter().any(|s| (s.family, s.id) == (expected.family, expected.id));
    let expected = poses.iter().flat_map(|pose| plain_view::expected(pose, scene, camera));
    StillMissing {
        // A pose that its tags hardly fit may be one that the tags not found yet refute.
        has_pose: located.as_ref().is_ok_and(|l| !l.warnings.contains(&Warning::PoorFit)),
        expected: expected.filter(|expected| !is_seen(expected)).collect(),
    }
}

/// The different poses that tags allow which were refused as too few or not good enough.
fn allowed(seen: &[SeenTag], scene: &Scene, camera: &Camera) -> Vec<Rigid> {
    let Ok((matches, _)) = matches::match_tags(seen, scene) else {
        return Vec::new();
    };
    let mut candidates = Solver::EveryBranch.candidates(&matches, camera);
    for only in matches.iter().filter(|_| matches.len() > 1) {
        candidates.extend(Solver::EveryBranch.candidates(std::slice::from_ref(only), camera));
    }
    candidates.sort_by(|a, b| a.rms_px.total_cmp(&b.rms_px));
    let mut poses: Vec<Rigid> = Vec::new();
    for candidate in candidates {
        if !poses.iter().any(|known| !doubt::is_different(known, &candidate.pose)) {
            poses.push(candidate.pose);
        }
    }
    poses.truncate(MOST_POSES);
    poses
}
