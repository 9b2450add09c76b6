//! Near-copies: photos that show the same moment again, re-encoded, made smaller, or as the next frame of a video. They are no evidence of their own,
//! and count once.

use std::collections::BTreeMap;
use std::path::Path;

use crate::figures::ScoredPhoto;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::angle::turn;
use scaleproof_photo::{Budget, Photo, bits_apart};
use scaleproof_pose::locate::Sigma;

/// Largest number of the 256 bits in which perceptual hashes of near-copies differ. Measured: JPEG qualities 20 to 90, 40 % of the size, or noise of
/// 6 grey levels change 33 bits at most in 200 photos (51 in one, nearly black); views that differ change 55 and more, unless little but the
/// background is seen.
const MOST_BITS: u32 = 48;

/// Largest mean difference in levels between the insides of the truth boxes of one photo: JPEG quality 20 changes 3 of them, another texture 20 and
/// more.
const MOST_LEVELS: f64 = 8.0;

/// Least IoU of the truth boxes of near-copies, as shares of their photos.
const LEAST_IOU: f64 = 0.96;

/// Largest difference between viewpoints of near-copies, in its standard deviations; the next two allow for what a held camera moves between frames.
const MOST_SIGMAS: f64 = 3.0;
const STILL_DEG: f64 = 0.5;
const STILL_SHARE: f64 = 0.005;

/// Takes near-copies out of photos: each later photo of the same texture, place and conditions that shows what an earlier one shows. Those that stay say how many they stand for;
/// the others come with the file of the photo that stands for them.
pub(crate) fn counted_once(photos: Vec<ScoredPhoto>) -> (Vec<ScoredPhoto>, Vec<(ScoredPhoto, String)>) {
    let (mut kept, mut copies): (Vec<ScoredPhoto>, _) = (Vec::new(), Vec::new());
    for photo in photos {
        match kept.iter_mut().find(|earlier| is_near_copy(earlier, &photo)) {
            Some(first) => {
                first.near_copies += 1;
                copies.push((photo, first.file.clone()));
            }
            None => kept.push(photo),
        }
    }
    (kept, copies)
}

/// Marks each photo that shows what an earlier one shows, whichever places and textures both are said to have.
pub(crate) fn mark_repeats(photos: &mut [ScoredPhoto]) {
    for i in 1..photos.len() {
        let (earlier, later) = photos.split_at_mut(i);
        let photo = &mut later[0];
        let first = earlier.iter().find(|first| is_repeat(first, photo));
        photo.repeat_of = first.map(|first| first.file.clone());
    }
}

/// Returns true if two photos are one. Of two textures from one viewpoint the images are alike but for the model, so that the model itself is
/// compared; without previews only the same bytes are the same photo.
fn is_repeat(a: &ScoredPhoto, b: &ScoredPhoto) -> bool {
    a.sha256 == b.sha256 || is_same_image(a, b) && shows_same_model(a, b).unwrap_or(false)
}

/// Returns true if the insides of both truth boxes are alike; `None` without previews.
fn shows_same_model(a: &ScoredPhoto, b: &ScoredPhoto) -> Option<bool> {
    let (a, b) = (model_in_preview(a)?, model_in_preview(b)?);
    let apart: u32 = a.iter().zip(b.iter()).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
    Some(f64::from(apart) / a.len() as f64 <= MOST_LEVELS)
}

/// Returns the inside of the truth box in the preview, reduced to a few pixels, as RGB bytes.
fn model_in_preview(photo: &ScoredPhoto) -> Option<Vec<u8>> {
    const SIDE: u32 = 32;
    let preview = Photo::from_bytes(Path::new(&photo.file), photo.preview_jpeg.clone(), Budget::UPLOAD).ok()?;
    let preview = preview.rgb(1).ok()?;
    let scale = f64::from(preview.width()) / f64::from(photo.width);
    let BoxPx { x1, y1, x2, y2 } = photo.truth;
    let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(|v| (v * scale).max(0.0) as u32);
    let model = image::imageops::crop_imm(&preview, x1, y1, (x2 - x1).max(1), (y2 - y1).max(1)).to_image();
    Some(image::imageops::resize(&model, SIDE, SIDE, image::imageops::FilterType::Triangle).into_raw())
}

fn is_near_copy(a: &ScoredPhoto, b: &ScoredPhoto) -> bool {
    let is_same_thing = a.variant == b.variant && a.place == b.place && a.conditions == b.conditions;
    is_same_thing && is_same_view(a, b) && (a.sha256 == b.sha256 || is_same_image(a, b))
}

fn is_same_image(a: &ScoredPhoto, b: &ScoredPhoto) -> bool {
    let [one, other] = [a, b].map(|photo| {
        let (width, height) = (f64::from(photo.width), f64::from(photo.height));
        let BoxPx { x1, y1, x2, y2 } = photo.truth;
        BoxPx::new(x1 / width, y1 / height, x2 / width, y2 / height)
    });
    bits_apart(&a.hash, &b.hash) <= MOST_BITS && one.iou(&other) >= LEAST_IOU
}

/// Returns true if both were taken from one viewpoint, as far as poses tell, or neither has a viewpoint.
fn is_same_view(a: &ScoredPhoto, b: &ScoredPhoto) -> bool {
    let (Some(one), Some(other)) = (a.viewpoint, b.viewpoint) else {
        return a.viewpoint.is_none() && b.viewpoint.is_none();
    };
    let noise = |of: fn(&Sigma) -> f64| {
        let sigmas = [a, b].map(|photo| photo.sigma.as_ref().map_or(0.0, of));
        MOST_SIGMAS * sigmas[0].hypot(sigmas[1])
    };
    // Near the zenith differences of azimuth mean little.
    let across = one.pitch_deg.to_radians().cos();
    let azimuth = across * turn(one.azimuth_deg, other.azimuth_deg).abs();
    let pitch = (one.pitch_deg - other.pitch_deg).abs();
    let distance = (one.distance_mm - other.distance_mm).abs();
    azimuth <= noise(|s| s.azimuth_deg).max(STILL_DEG)
        && pitch <= noise(|s| s.pitch_deg).max(STILL_DEG)
        && distance <= noise(|s| s.distance_mm).max(STILL_SHARE * one.distance_mm)
}

/// Returns pairs of photos with one SHA-256: the last one before, and its copy.
pub(crate) fn identical_photos(photos: &[ScoredPhoto]) -> impl Iterator<Item = (&ScoredPhoto, &ScoredPhoto)> {
    let mut seen: BTreeMap<&str, &ScoredPhoto> = BTreeMap::new();
    photos
        .iter()
        .filter_map(move |p| seen.insert(&p.sha256, p).map(|earlier| (earlier, p)))
}
