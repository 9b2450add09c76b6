//! Photos whose own tags contradict what the list of their session says: the viewpoint or the box.
//!
//! A list spares the search for tags, so that it is held against one photo in ten. Where one of them contradicts it, all photos of the session are
//! looked at.

use std::collections::{BTreeMap, BTreeSet};

use super::observe::{Observation, ScoringJob};
use super::{NotScored, NotScoredReason, ScoredPhoto};
use scaleproof_core::files::sha256_hex;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::locate::{Located, Warning, locate_tags};
use scaleproof_pose::scene::{Bins, Viewpoint};

/// Of so many photos of a texture the tags of one are searched; of fewer, of one.
const ONE_IN: usize = 10;

/// A list contradicts tags where it differs from them by more than so many standard deviations of what they say …
const LEAST_SIGMAS: f64 = 5.0;

/// … and by more than this share of the distance, or by more than half a bin: planned viewpoints are honest, though nobody stands right there.
const LEAST_SHARE: f64 = 0.1;

/// Half a bin of pitch where the scene has one pitch, which has no edge: as of azimuth in eight directions.
const LONE_HALF_DEG: f64 = 22.5;

/// A listed box and the model by the tags have this IoU at least.
const LEAST_IOU: f64 = 0.3;

/// What a look at a photo comes to.
pub(super) struct Judged {
    pub photo: Result<ScoredPhoto, NotScored>,
    /// In what its tags contradict the list, where they were searched.
    pub contradiction: Option<NotScoredReason>,
}

/// Whether a photo that the list places could be located, too.
pub(super) fn is_checkable(job: &ScoringJob) -> bool {
    !job.needs_tags() && !job.session.scene.tags.is_empty() && job.session.camera.is_some()
}

/// Draws the photos that are checked. By a hash of their names: a list that turns the wrong way round is right of its first photo, the front.
pub(super) fn draw(jobs: &mut [ScoringJob]) {
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

/// The photos, by index, whose tags have to be searched because others of their session contradict the list.
pub(super) fn left_open(jobs: &[ScoringJob], judged: &[Judged]) -> Vec<usize> {
    let doubted = doubted(jobs, judged);
    let is_open = |at: &usize| {
        let (job, photo) = (&jobs[*at], &judged[*at].photo);
        doubted.contains(&job.session_index) && is_checkable(job) && !job.is_checked && photo.is_ok()
    };
    (0..jobs.len()).filter(is_open).collect()
}

/// The photos; where one that every run looks at contradicts its list, those of that session that contradict it are left out. What shards alone saw
/// changes nothing.
pub(super) fn refused(jobs: &[ScoringJob], judged: Vec<Judged>) -> Vec<Result<ScoredPhoto, NotScored>> {
    let doubted = doubted(jobs, &judged);
    let refused = |(job, judged): (&ScoringJob, Judged)| match judged.contradiction {
        Some(reason) if doubted.contains(&job.session_index) => judged.photo.and(Err(job.left_out(reason))),
        _ => judged.photo,
    };
    jobs.iter().zip(judged).map(refused).collect()
}

/// The sessions, by index, whose list a photo contradicts that every run looks at.
fn doubted(jobs: &[ScoringJob], judged: &[Judged]) -> BTreeSet<usize> {
    let is_contradicted =
        |(job, judged): &(&ScoringJob, &Judged)| (job.is_checked || job.needs_tags()) && judged.contradiction.is_some();
    let contradicted = jobs.iter().zip(judged).filter(is_contradicted);
    contradicted.map(|(job, _)| job.session_index).collect()
}

/// In what a photo's tags contradict the list. A photo without a pose, or with an open one, contradicts nothing.
pub(super) fn contradiction(job: &ScoringJob, seen: &Observation) -> Option<NotScoredReason> {
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

/// What differs between a listed viewpoint and that of the tags, with both values.
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

/// From the middle of the bin that a viewpoint is in to the edge of it that is nearer.
fn half_pitch_deg(v: &Viewpoint, bins: &Bins) -> f64 {
    let centre = bins.bin_of(v).pitch_deg;
    let others = bins.pitch_deg.iter().map(|other| (other - centre).abs() / 2.0);
    let nearest = others.filter(|half| *half > 0.0).reduce(f64::min);
    nearest.unwrap_or(LONE_HALF_DEG)
}

/// That a listed box is not the model's, with both.
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
