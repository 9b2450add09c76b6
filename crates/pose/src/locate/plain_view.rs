//! Tags that a pose predicts besides those it rests on: to stop a search when nothing is missing, and to reject a pose that the photo contradicts.
//!
//! A lone tag whose card was turned, or that was misread, fits perfectly in a wrong place. The rest of the image can contradict it: the model is
//! outside the image, or tags that should be in plain view are missing.

use super::abstention::Abstention;
use super::matches::{self, Match, area_px};
use super::solver::Solver;
use super::{Located, Warning, doubt};
use crate::camera::Camera;
use crate::scene::{Scene, Tag};
use crate::tags::{ExpectedTag, SeenTag, StillMissing};
use scaleproof_core::geometry::Rigid;

/// Cosine of the angle (60°) beyond which a detector may miss a turned tag.
const FACING: f64 = 0.5;

/// Border of the image, as a share of its sides, within which a tag may be cut or blurred.
const BORDER: f64 = 0.05;

/// Margin by which the model may exceed its box, mm.
const MODEL_MARGIN_MM: f64 = 20.0;

/// Number of missing tags that refutes a pose; a single one may be covered by a hand or have fallen over.
const MISSING: usize = 2;

/// Returns an error for a pose of a lone tag that the rest of the photo contradicts. `seen`: all tags found in the photo.
pub(super) fn check_plain_view(
    only: &Match,
    pose: &Rigid,
    seen: &[SeenTag],
    scene: &Scene,
    camera: &Camera,
) -> Result<(), Abstention> {
    let id = only.tag.id;
    let target = camera.project(&(pose * scene.model.target_mm()));
    if !target.is_some_and(|pixel| is_inside(pixel, camera, 0.0)) {
        return Err(Abstention::OneTagNoModel { id });
    }
    let is_seen = |tag: &Tag| seen.iter().any(|s| (s.family, s.id) == (tag.family, tag.id));
    let is_missing = |tag: &&Tag| !is_seen(tag) && is_in_plain_view(tag, only.area_px(), pose, scene, camera);
    let missing: Vec<u32> = scene.tags.iter().filter(is_missing).map(|tag| tag.id).collect();
    if missing.len() >= MISSING {
        return Err(Abstention::OneTagMissesOthers { id, missing });
    }
    Ok(())
}

/// Returns true if a tag faces the camera, lies well inside the image, is not hidden by the model, and covers at least `least_px2`.
fn is_in_plain_view(tag: &Tag, least_px2: f64, pose: &Rigid, scene: &Scene, camera: &Camera) -> bool {
    let is_inside = |pixel: &[f64; 2]| is_inside(*pixel, camera, BORDER);
    let visible = scene.visible_px(tag, (FACING, MODEL_MARGIN_MM), pose, camera);
    visible.is_some_and(|seen| area_px(&seen) >= least_px2 && seen.iter().all(is_inside))
}

/// Maximum number of alternative poses from which tags are predicted while there is no unique pose.
const MOST_POSES: usize = 4;

/// Returns the tags still missing, predicted by the pose or, without one, by the poses the tags allow; without any tag, by a guess.
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
    let expected = poses.iter().flat_map(|pose| expected(pose, scene, camera));
    StillMissing {
        // A pose with poor fit may be refuted by tags that are not found yet.
        has_pose: located.as_ref().is_ok_and(|l| !l.warnings.contains(&Warning::PoorFit)),
        expected: expected.filter(|expected| !is_seen(expected)).collect(),
    }
}

/// Returns the different poses that the tags allow, although refused as ambiguous or imprecise.
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
        if poses.iter().all(|known| doubt::is_different(known, &candidate.pose)) {
            poses.push(candidate.pose);
        }
    }
    poses.truncate(MOST_POSES);
    poses
}

/// Cosine of the angle (78°) beyond which a turned tag cannot be read.
const LEAST_FACING: f64 = 0.2;

/// Size of a tag's bit cells, px, below which a tag in plain view may be missed.
const PLAIN_CELL_PX: f64 = 3.0;

/// Returns the tags that a pose predicts in the photo, with their corners.
fn expected(pose: &Rigid, scene: &Scene, camera: &Camera) -> Vec<ExpectedTag> {
    let expected = |tag: &Tag| {
        let corners_px = scene.visible_px(tag, (LEAST_FACING, 0.0), pose, camera)?;
        let least_px2 = (PLAIN_CELL_PX * tag.family.cells_across()).powi(2);
        let is_inside = corners_px.iter().all(|pixel| is_inside(*pixel, camera, 0.0));
        is_inside.then(|| ExpectedTag {
            family: tag.family,
            id: tag.id,
            corners_px,
            is_in_plain_view: is_in_plain_view(tag, least_px2, pose, scene, camera),
        })
    };
    scene.tags.iter().filter_map(expected).collect()
}

/// Returns true if a pixel lies in the image without its border, given as a share of the sides.
fn is_inside([x, y]: [f64; 2], camera: &Camera, border: f64) -> bool {
    let within = |v: f64, size: u32| {
        let size = f64::from(size);
        (border * size..(1.0 - border) * size).contains(&v)
    };
    within(x, camera.width) && within(y, camera.height)
}
