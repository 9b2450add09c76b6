//! Photos whose own tags contradict the viewpoint or the box in the list of their session.
//!
//! A list saves the search for tags, so it is checked on one photo in ten. Where one of them contradicts it, all photos of the session are checked.

use std::collections::{BTreeMap, BTreeSet};

use crate::figures::{NotScored, ScoredPhoto};
use crate::observe::{NotScoredReason, Observation, ScoringJob};
use scaleproof_core::files::sha256_hex;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::locate::{Located, Warning, locate_tags};
use scaleproof_pose::scene::{Bins, Viewpoint};

/// Number of photos of a texture of which one is checked; of fewer one is, too.
const ONE_IN: usize = 10;

/// Least difference between list and tags that is a contradiction, in standard deviations of the tags' viewpoint …
const LEAST_SIGMAS: f64 = 5.0;

/// … and for the distance as a share of it; for angles it is half a bin. Planned viewpoints are honest, though nobody stands right there.
const LEAST_SHARE: f64 = 0.1;

/// Half a bin of elevation, degrees, where the scene has one elevation, which has no edge: as of azimuth in eight directions.
const LONE_HALF_DEG: f64 = 22.5;

/// Least IoU of a listed box with the model by the tags.
const LEAST_IOU: f64 = 0.3;

/// Result of observing a photo.
pub(crate) struct JudgedPhoto {
    pub photo: Result<ScoredPhoto, NotScored>,
    /// Contradiction between its tags and the list, where the tags were searched.
    pub contradiction: Option<NotScoredReason>,
}

/// Returns true if a photo that the list places could be located, too.
pub(crate) fn is_checkable(job: &ScoringJob) -> bool {
    !job.needs_tags() && !job.session.scene.tags.is_empty() && job.session.camera.is_some()
}

/// Draws the photos that are checked, by a hash of their names: a list that turns the wrong way round is right for its first photo, the front.
pub(crate) fn draw(jobs: &mut [ScoringJob]) {
    let mut textures: BTreeMap<(usize, &str), Vec<(String, usize)>> = BTreeMap::new();
    for (at, job) in jobs.iter().enumerate().filter(|(_, job)| is_checkable(job)) {
        let own = textures.entry((job.session_index, &job.entry.variant)).or_default();
        own.push((sha256_hex(job.entry.file.as_bytes()), at));
    }
    for mut photos in textures.into_values() {
        photos.sort();
        let drawn = photos.len().div_ceil(ONE_IN);
        photos[..drawn].iter().for_each(|(_, at)| jobs[*at].is_checked = true);
    }
}

/// Returns the photos, by index, whose tags have to be searched because others of their session contradict the list.
pub(crate) fn left_open(jobs: &[ScoringJob], judged: &[JudgedPhoto]) -> Vec<usize> {
    let doubted = doubted(jobs, judged);
    let is_open = |at: &usize| {
        let (job, photo) = (&jobs[*at], &judged[*at].photo);
        doubted.contains(&job.session_index) && is_checkable(job) && !job.is_checked && photo.is_ok()
    };
    (0..jobs.len()).filter(is_open).collect()
}

/// Returns the photos; in a session whose list a photo contradicts that every run checks, those that contradict it are left out. Contradictions that
/// shards alone found change nothing.
pub(crate) fn refused(jobs: &[ScoringJob], judged: Vec<JudgedPhoto>) -> Vec<Result<ScoredPhoto, NotScored>> {
    let doubted = doubted(jobs, &judged);
    let refused = |(job, judged): (&ScoringJob, JudgedPhoto)| match judged.contradiction {
        Some(reason) if doubted.contains(&job.session_index) => judged.photo.and(Err(job.left_out(reason))),
        _ => judged.photo,
    };
    jobs.iter().zip(judged).map(refused).collect()
}

/// Returns the sessions, by index, whose list a photo contradicts that every run checks.
fn doubted(jobs: &[ScoringJob], judged: &[JudgedPhoto]) -> BTreeSet<usize> {
    let is_contradicted = |(job, judged): &(&ScoringJob, &JudgedPhoto)| {
        (job.is_checked || job.needs_tags()) && judged.contradiction.is_some()
    };
    let contradicted = jobs.iter().zip(judged).filter(is_contradicted);
    contradicted.map(|(job, _)| job.session_index).collect()
}

/// Returns the contradiction between a photo's tags and the list. A photo without a pose, or with an open one, contradicts nothing.
pub(crate) fn contradiction(job: &ScoringJob, seen: &Observation) -> Option<NotScoredReason> {
    let (entry, session) = (job.entry, job.session);
    if seen.tags.is_empty() || entry.viewpoint.is_none() && entry.box_xyxy_px.is_none() {
        return None;
    }
    let size = (seen.width, seen.height);
    let camera = session.camera.as_ref()?;
    let photo = locate_tags(seen.tags.clone(), size, seen.turned_deg, &session.scene, camera);
    let (located, fitted) = photo.pose_and_camera().ok()?;
    if located.warnings.contains(&Warning::OpenPose) {
        return None;
    }
    let mut differences = Vec::new();
    if let Some(listed) = &entry.viewpoint {
        differences.extend(of_viewpoint(listed, &located, &session.scene.bins));
    }
    let model = session.outline.box_in_photo(&located.pose, &fitted.camera).ok();
    if let Some((listed, model)) = entry.box_xyxy_px.zip(model) {
        differences.extend(of_box(&listed.clipped(size.0.into(), size.1.into()), &model));
    }
    (!differences.is_empty()).then(|| {
        NotScoredReason::new(format!(
            "the list contradicts the photo's own tags ({}): correct the list, or the scene and camera files if those are wrong",
            differences.join("; ")
        ))
    })
}

/// Returns the differences between a listed viewpoint and that of the tags, with both values.
fn of_viewpoint(listed: &Viewpoint, located: &Located, bins: &Bins) -> Vec<String> {
    let (tags, sigma) = (&located.viewpoint, &located.sigma);
    let azimuth = turn(listed.azimuth_deg, tags.azimuth_deg);
    let pitch = tags.pitch_deg - listed.pitch_deg;
    let distance = tags.distance_mm - listed.distance_mm;
    let half = bins.azimuth_deg / 2.0;
    let share = LEAST_SHARE * tags.distance_mm;
    let compared = [
        (
            "azimuth_deg",
            azimuth,
            half,
            sigma.azimuth_deg,
            listed.azimuth_deg,
            tags.azimuth_deg,
        ),
        (
            "pitch_deg",
            pitch,
            half_pitch_deg(listed, bins),
            sigma.pitch_deg,
            listed.pitch_deg,
            tags.pitch_deg,
        ),
        (
            "distance_mm",
            distance,
            share,
            sigma.distance_mm,
            listed.distance_mm,
            tags.distance_mm,
        ),
    ];
    let differing = compared
        .into_iter()
        .filter(|(_, off, least, sigma, ..)| off.abs() > least.max(LEAST_SIGMAS * sigma));
    let said = differing
        .map(|(what, .., listed, tags)| format!("{what} is {listed:.1} in the list and {tags:.1} by the tags"));
    said.collect()
}

/// Returns the elevation from the middle of a viewpoint's bin to the nearer of its edges, degrees.
fn half_pitch_deg(v: &Viewpoint, bins: &Bins) -> f64 {
    let centre = bins.bin_of(v).pitch_deg;
    let others = bins.pitch_deg.iter().map(|other| (other - centre).abs() / 2.0);
    let nearest = others.filter(|half| *half > 0.0).reduce(f64::min);
    nearest.unwrap_or(LONE_HALF_DEG)
}

/// Returns a sentence with both boxes if a listed box is not the model's.
fn of_box(listed: &BoxPx, model: &BoxPx) -> Option<String> {
    let iou = listed.iou(model);
    let px = |b: &BoxPx| format!("[{:.0}, {:.0}, {:.0}, {:.0}]", b.x1, b.y1, b.x2, b.y2);
    (iou < LEAST_IOU).then(|| {
        format!(
            "box_xyxy_px is {} in the list and {} by the tags, an IoU of {iou:.2}",
            px(listed),
            px(model)
        )
    })
}
