//! Held-out error of a pose, which needs no truth: a tag is left out, and its corners are predicted from the others.

use std::convert::Infallible;

use image::GrayImage;

use super::method::Method;
use crate::chart::timed_tags;
use scaleproof_core::workers::{self, fastest};
use scaleproof_photo::{Filter, Photo, PhotoError, grey_resized};
use scaleproof_pose::camera::{Camera, FittedCamera};
use scaleproof_pose::locate::{Located, locate_by};
use scaleproof_pose::scene::{Scene, Tag};
use scaleproof_pose::tags::{SeenTag, TagDetector, TagDetectorChoice};
use scaleproof_session::{PhotoEntry, Session};

#[derive(Debug, Clone)]
pub struct Sample {
    pub file: String,
    /// Luma of the upright photo.
    pub luma: GrayImage,
    /// Degrees by which EXIF turned the photo clockwise.
    pub turned_deg: u32,
}

impl Sample {
    /// Decodes the photos of a session; returns them, and the reasons why some cannot be decoded. `on_photo` is called after each, from any thread.
    pub fn all_of(session: &Session, on_photo: impl Fn() + Sync) -> (Vec<Self>, Vec<PhotoError>) {
        let decoded = |(): &mut (), entry: &PhotoEntry| {
            let photo = Photo::open(&session.photo_path(entry));
            Ok(photo.and_then(|photo| {
                Ok(Self {
                    file: entry.file.clone(),
                    luma: photo.luma()?,
                    turned_deg: photo.turned_deg,
                })
            }))
        };
        let Ok(photos) = workers::map(&session.photos, || Ok::<_, Infallible>(()), decoded, on_photo);
        let (samples, faults): (Vec<_>, Vec<_>) = photos.into_iter().partition(Result::is_ok);
        let faults = faults.into_iter().filter_map(Result::err).collect();
        (samples.into_iter().flatten().collect(), faults)
    }
}

#[derive(Debug, Clone)]
pub(super) struct MethodResult {
    pub ms: f64,
    pub located: Option<Located>,
    /// Root mean square distance between the corners of a left-out tag and where the pose from the others puts them, degrees; mean over the tags.
    pub held_out_deg: Option<f64>,
}

/// Tags in a photo, at the size at which they were found.
pub(super) struct FoundTags {
    pub tags: Vec<SeenTag>,
    /// Time of finding them, ms, where it is measured.
    pub ms: f64,
    /// Width and height, px.
    pub size: (u32, u32),
}

/// Finds the tags of a photo that is reduced first, and measures the time of that.
pub(super) fn find(
    sample: &Sample,
    choice: TagDetectorChoice,
    reduced_by: u32,
    scene: &Scene,
    camera: &Camera,
    detector: &mut dyn TagDetector,
) -> FoundTags {
    let luma = &sample.luma;
    let (width, height) = luma.dimensions();
    let reduced = (reduced_by > 1).then(|| {
        let size = [width, height].map(|side| (side / reduced_by).max(1));
        grey_resized(luma, size, Filter::Bilinear)
    });
    let luma = reduced.as_ref().unwrap_or(luma);
    let (tags, ms) = timed_tags(choice, detector, (luma, sample.turned_deg), scene, camera);
    let size = luma.dimensions();
    FoundTags { tags, ms, size }
}

/// Locates a photo by a way, and computes how well poses without a tag predict it. `reference`: the tags that are left out one by one, as they were
/// seen at full size.
pub(super) fn answer(
    way: &Method,
    sample: &Sample,
    seen: &FoundTags,
    reference: &[SeenTag],
    scene: &Scene,
    camera: &Camera,
) -> MethodResult {
    let camera = way.camera(camera);
    let (width, height) = seen.size;
    let Ok(FittedCamera { camera, .. }) = camera.for_photo(width, height, sample.turned_deg) else {
        return MethodResult {
            ms: seen.ms,
            located: None,
            held_out_deg: None,
        };
    };
    let locate = |without: Option<&SeenTag>| {
        let (tags, scene) = limited(way.most_tags, &seen.tags, scene, without);
        locate_by(way.solver, &tags, &scene, &camera).ok()
    };
    let (located, solve_ms) = fastest(|| locate(None));
    let scale = f64::from(width) / f64::from(sample.luma.width());
    let error = |left_out: &SeenTag| {
        let tag = scene.tag(left_out.family, left_out.id)?;
        let without = locate(Some(left_out))?;
        Some(distance_px(&without, tag, left_out, &camera, scale)? * camera.deg_per_px())
    };
    let errors: Vec<f64> = reference.iter().filter_map(error).collect();
    MethodResult {
        ms: seen.ms + solve_ms,
        located,
        held_out_deg: (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64),
    }
}

/// Returns the tags without one, the largest alone, and the scene as if the others were not there: otherwise a lone tag is doubted because they are
/// not seen.
fn limited(most: Option<usize>, seen: &[SeenTag], scene: &Scene, without: Option<&SeenTag>) -> (Vec<SeenTag>, Scene) {
    let is_known = |tag: &SeenTag| scene.tag(tag.family, tag.id).is_some();
    let (mut tags, mut scene) = (seen.to_vec(), scene.clone());
    if let Some(out) = without {
        tags.retain(|tag| (tag.family, tag.id) != (out.family, out.id));
        scene.tags.retain(|tag| (tag.family, tag.id) != (out.family, out.id));
    }
    if let Some(most) = most {
        let (mut known, unknown): (Vec<SeenTag>, Vec<SeenTag>) = tags.into_iter().partition(is_known);
        known.sort_by(|a, b| area_px(b).total_cmp(&area_px(a)));
        known.truncate(most);
        let is_kept = |tag: &Tag| known.iter().any(|seen| (seen.family, seen.id) == (tag.family, tag.id));
        scene.tags.retain(is_kept);
        tags = known.into_iter().chain(unknown).collect();
    }
    (tags, scene)
}

fn area_px(tag: &SeenTag) -> f64 {
    let c = tag.corners_px;
    let cross = |i: usize, next: usize| c[i][0] * c[next][1] - c[next][0] * c[i][1];
    let doubled: f64 = (0..4).map(|i| cross(i, (i + 1) % 4)).sum();
    doubled.abs() / 2.0
}

/// Computes the root mean square distance over the corners, px. `scale`: width of the image that the camera fits over that in which the tag was seen.
fn distance_px(located: &Located, tag: &Tag, seen: &SeenTag, camera: &Camera, scale: f64) -> Option<f64> {
    let mut sum = 0.0;
    for (corner, at) in tag.corners_mm().iter().zip(seen.corners_px) {
        let [x, y] = camera.project(&(located.pose * corner))?;
        // The centre of the first pixel is (0, 0).
        let [u, v] = at.map(|full| (full + 0.5) * scale - 0.5);
        sum += (x - u).powi(2) + (y - v).powi(2);
    }
    Some((sum / 4.0).sqrt())
}
