//! What a pose says the photo should show besides the tag it rests on.
//!
//! A lone tag whose card was turned, or that was read as another one, fits perfectly in a wrong place. The rest of the image
//! can contradict it: the model is not where the camera looks, or tags that should be in plain view are not there.

use super::abstention::Abstention;
use super::matches::{Match, area_px};
use crate::camera::Camera;
use crate::geometry::Rigid;
use crate::scene::{Scene, Tag};
use crate::tags::SeenTag;
use nalgebra::Point3;

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
    let centre = pose.inverse() * Point3::origin();
    let is_facing = tag.right.cross(&tag.up).dot(&(centre - tag.centre_mm).normalize()) > FACING;
    let corners = tag.corners_mm();
    let is_clear = |corner: &Point3<f64>| !scene.model.hides(*corner, centre, MODEL_MARGIN_MM);
    if !is_facing || !corners.iter().all(is_clear) {
        return false;
    }
    let pixels: Option<Vec<[f64; 2]>> = corners.iter().map(|c| camera.project(&(pose * c))).collect();
    let Some([a, b, c, d]) = pixels.as_deref() else {
        return false;
    };
    let outline = [*a, *b, *c, *d];
    outline.iter().all(|pixel| is_inside(*pixel, camera, BORDER)) && area_px(&outline) >= least_px2
}

/// Whether a pixel lies in the image without a border, a share of its sides.
fn is_inside([x, y]: [f64; 2], camera: &Camera, border: f64) -> bool {
    let within = |v: f64, size: u32| {
        let size = f64::from(size);
        (border * size..(1.0 - border) * size).contains(&v)
    };
    within(x, camera.width) && within(y, camera.height)
}
