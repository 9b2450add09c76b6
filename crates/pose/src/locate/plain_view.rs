//! What a pose says the photo should show besides the tag it rests on.
//!
//! A lone tag whose card was turned, or that was read as another one, fits perfectly in a wrong place. The rest of the image
//! can contradict it: the model is not where the camera looks, or tags that should be in plain view are not there.

use super::abstention::Abstention;
use super::matches::{Match, area_px};
use crate::camera::Camera;
use crate::scene::{Scene, Tag};
use crate::tags::{ExpectedTag, SeenTag, cells_across};
use nalgebra::Point3;
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
    let expected = scene.tags.iter().filter(|tag| !is_seen(tag));
    let missing: Vec<u32> = expected
        .filter(|tag| is_in_plain_view(tag, only.area_px(), pose, scene, camera))
        .map(|tag| tag.id)
        .collect();
    if missing.len() >= MISSING {
        return Err(Abstention::OneTagMissesOthers { id, missing });
    }
    Ok(())
}

/// Whether a tag faces the camera, well inside the image, clear of the model, and looks at least as large as the one that was seen.
fn is_in_plain_view(tag: &Tag, least_px2: f64, pose: &Rigid, scene: &Scene, camera: &Camera) -> bool {
    let is_clear =
        |seen: &[[f64; 2]; 4]| area_px(seen) >= least_px2 && seen.iter().all(|pixel| is_inside(*pixel, camera, BORDER));
    visible(tag, pose, FACING, MODEL_MARGIN_MM, scene, camera).is_some_and(|seen| is_clear(&seen))
}

/// Tags turned further away than this show no code: cosine of 78°.
const LEAST_FACING: f64 = 0.2;

/// A tag in plain view whose bit cells are smaller than this may be missed, px.
const PLAIN_CELL_PX: f64 = 3.0;

/// The tags that a pose lets a photo show, and where.
pub(super) fn expected(pose: &Rigid, scene: &Scene, camera: &Camera) -> Vec<ExpectedTag> {
    let of = |tag: &Tag| {
        let corners_px = visible(tag, pose, LEAST_FACING, 0.0, scene, camera)?;
        let least_px2 = (PLAIN_CELL_PX * cells_across(tag.family)).powi(2);
        corners_px
            .iter()
            .all(|pixel| is_inside(*pixel, camera, 0.0))
            .then(|| ExpectedTag {
                family: tag.family,
                id: tag.id,
                corners_px,
                is_in_plain_view: is_in_plain_view(tag, least_px2, pose, scene, camera),
            })
    };
    scene.tags.iter().filter_map(of).collect()
}

/// Where a tag is in the image, or outside it, if it faces the camera so much and the model, grown by a margin, does not hide it.
fn visible(
    tag: &Tag,
    pose: &Rigid,
    facing: f64,
    margin_mm: f64,
    scene: &Scene,
    camera: &Camera,
) -> Option<[[f64; 2]; 4]> {
    let centre = pose.inverse() * Point3::origin();
    let is_facing = tag.right.cross(&tag.up).dot(&(centre - tag.centre_mm).normalize()) > facing;
    let corners = tag.corners_mm();
    let is_clear = |corner: &Point3<f64>| !scene.model.hides(*corner, centre, margin_mm);
    if !is_facing || !corners.iter().all(is_clear) {
        return None;
    }
    let [a, b, c, d] = corners.map(|corner| camera.project(&(pose * corner)));
    Some([a?, b?, c?, d?])
}

/// Whether a pixel lies in the image without a border, a share of its sides.
fn is_inside([x, y]: [f64; 2], camera: &Camera, border: f64) -> bool {
    let within = |v: f64, size: u32| {
        let size = f64::from(size);
        (border * size..(1.0 - border) * size).contains(&v)
    };
    within(x, camera.width) && within(y, camera.height)
}
