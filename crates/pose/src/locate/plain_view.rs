//! What a pose says the photo should show besides the tags it rests on: for a search that stops when nothing is missing, and against a pose that
//! the photo contradicts.
//!
//! A lone tag whose card was turned, or that was read as another one, fits perfectly in a wrong place. The rest of the image
//! can contradict it: the model is not where the camera looks, or tags that should be in plain view are not there.

use super::abstention::Abstention;
use super::matches::{self, Match, area_px};
use super::solver::Solver;
use super::{Located, Warning, doubt};
use crate::camera::Camera;
use crate::scene::{Scene, Tag};
use crate::tags::{ExpectedTag, SeenTag, StillMissing};
use scaleproof_core::geometry::Rigid;

/// Tags further turned away than this may be missed by a detector: cosine of 60°.
const FACING: f64 = 0.5;

/// Share of the image's sides within which a tag may be cut or blurred.
const BORDER: f64 = 0.05;

/// The model is not exactly its box, mm.
const MODEL_MARGIN_MM: f64 = 20.0;

/// One tag may be covered by a hand or have fallen over; so many are not all missed.
const MISSING: usize = 2;

/// Refuses the pose of a lone tag that the rest of the photo contradicts. `seen`: everything that was found in it.
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

/// Whether a tag faces the camera, well inside the image, clear of the model, and looks at least as large as the one that was seen.
fn is_in_plain_view(tag: &Tag, least_px2: f64, pose: &Rigid, scene: &Scene, camera: &Camera) -> bool {
    let is_inside = |pixel: &[f64; 2]| is_inside(*pixel, camera, BORDER);
    let visible = scene.visible_px(tag, (FACING, MODEL_MARGIN_MM), pose, camera);
    visible.is_some_and(|seen| area_px(&seen) >= least_px2 && seen.iter().all(is_inside))
}

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
    let expected = poses.iter().flat_map(|pose| expected(pose, scene, camera));
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
        if poses.iter().all(|known| doubt::is_different(known, &candidate.pose)) {
            poses.push(candidate.pose);
        }
    }
    poses.truncate(MOST_POSES);
    poses
}

/// Tags turned further away than this show no code: cosine of 78°.
const LEAST_FACING: f64 = 0.2;

/// A tag in plain view whose bit cells are smaller than this may be missed, px.
const PLAIN_CELL_PX: f64 = 3.0;

/// The tags that a pose lets a photo show, and where.
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

/// Whether a pixel lies in the image without a border, a share of its sides.
fn is_inside([x, y]: [f64; 2], camera: &Camera, border: f64) -> bool {
    let within = |v: f64, size: u32| {
        let size = f64::from(size);
        (border * size..(1.0 - border) * size).contains(&v)
    };
    within(x, camera.width) && within(y, camera.height)
}
