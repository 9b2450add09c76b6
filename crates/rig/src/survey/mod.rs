//! Survey: where tags stand that were placed by hand, from photos and the tags' sizes alone.
//!
//! Some tags are *fixed*: their poses in the model frame are given (a printed ground mat, or one origin tag). All other tags and
//! all photos are adjusted together (bundle adjustment) around them.

mod adjust;
mod edges;
mod grow;
mod look;
mod network;
mod planar;
mod problem;
mod residual;
mod sizes;
mod suspects;

use adjust::{Free, Loss, adjust};
use network::{Poses, Sighting, SizedTag, TagKey, TagNetwork};
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Scene, Tag, TagFamily, TagSigma};
use scaleproof_pose::tags::SeenTag;
use suspects::TagFault;

pub use look::{SurveyPhotos, look};
pub use problem::{LeftOutReason, SurveyError};
pub use sizes::Sizes;

/// A noise above this angle is no noise: the wrong camera, or wrong sizes.
const MAX_NOISE_DEG: f64 = 0.1;

/// A tag or photo may be in another pose when that leaves less than this many times the residual.
const MIN_RIVAL_RATIO: f64 = 3.0;

/// A tag that one photo shows rests on eight numbers for its six: its rival must leave more, and a view straight on, where the two
/// planar branches melt into one pose, does not do. The same as for a lone tag in `locate`.
const MIN_LONE_RIVAL_RATIO: f64 = 5.0;
const MIN_LONE_TILT_DEG: f64 = 15.0;

/// Residuals below this are luck when two poses are compared, px.
const NOISE_FLOOR_PX: f64 = 0.1;

/// The tags that were found in one photo.
#[derive(Debug, Clone)]
pub struct PhotoTags {
    /// What messages call the photo.
    pub name: String,
    pub seen: Vec<SeenTag>,
}

/// What is known before the survey.
#[derive(Debug, Clone, Copy)]
pub struct SurveyInput<'a> {
    /// Model, bins, and the fixed tags' poses; other tags only lend their sizes.
    pub scene: &'a Scene,
    /// The tags that keep the scene's pose.
    pub fixed: &'a [(TagFamily, u32)],
    /// Sizes of `family`; they go before those of the scene.
    pub sizes: Option<&'a Sizes>,
    pub family: TagFamily,
}

/// A surveyed scene.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The given model and bins; the fixed tags as given, then the surveyed ones with their σ, by family and id.
    pub scene: Scene,
    pub tags: Vec<TagReport>,
    pub left_out: Vec<LeftOutTag>,
    /// In the order given.
    pub photos: Vec<PhotoReport>,
    /// σ of a corner coordinate, px: what the residuals say.
    pub noise_px: f64,
    /// How far all tag edges were found too far in, px; taken out of the result.
    pub edge_shift_px: f64,
}

/// One tag of the surveyed scene.
#[derive(Debug, Clone, PartialEq)]
pub struct TagReport {
    pub family: TagFamily,
    pub id: u32,
    pub is_fixed: bool,
    /// Photos its pose rests on. With one, nothing checks that it has not moved and has its stated size.
    pub photos: usize,
    /// From the pose in the given scene, when it has one: mm and degrees.
    pub shift: Option<(f64, f64)>,
}

/// A seen tag that is not in the surveyed scene.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutTag {
    pub family: TagFamily,
    pub id: u32,
    pub reason: LeftOutReason,
}

/// What one photo gave.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PhotoReport {
    #[serde(rename = "file")]
    pub name: String,
    /// `T_camera_model`, mm; `None` when the photo could not be used.
    #[serde(skip)]
    pub pose: Option<Rigid>,
    /// Ids of the tags used, ascending.
    pub tags: Vec<u32>,
    /// Ids of tags that were seen here but not used here: partly covered, twice in the photo, badly seen, or left out.
    pub ignored_tags: Vec<u32>,
    pub rms_px: Option<f64>,
}

/// Surveys the tags that the photos show.
///
/// Both planar branches of every sighting (IPPE: Collins & Bartoli 2014) are candidates for a start, photo by photo
/// (`grow.rs`). All poses are then adjusted together under a robust loss, with one shift that all tag edges share (`edges.rs`).
/// Tags that the photos disagree about are named and left out (`suspects.rs`). The rest is adjusted once more by least squares,
/// whose covariance, inflated by the residuals, gives each σ.
pub fn survey(photos: &[PhotoTags], given: &SurveyInput, camera: &Camera) -> Result<Survey, SurveyError> {
    let (mut net, mut left_out) = network(photos, given, camera)?;
    check_connected(&net)?;
    let mut poses = grow::grown(&net).map_err(|_| SurveyError::TwoArrangements)?;
    let (noise_px, rough) = (suspects::noise_px(&net, &poses), grow::rough(&net));
    let shared = edges::fit(&mut net, &mut poses, rough, 0.0, noise_px);
    let net = without_suspects(net, &mut poses, photos, &mut left_out)?;
    let net = without_doubtful(net, &mut poses, photos, &mut left_out);
    check_connected(&net)?;
    finished(net, poses, shared.moved_px, photos, given, left_out)
}

/// The usable sightings: whole tags of known size that are seen once in the photo.
fn network<'a>(
    photos: &[PhotoTags],
    given: &SurveyInput,
    camera: &'a Camera,
) -> Result<(TagNetwork<'a>, Vec<LeftOutTag>), SurveyError> {
    let mut keys: Vec<TagKey> = photos.iter().flat_map(|p| &p.seen).map(|s| (s.family, s.id)).collect();
    keys.extend(given.fixed);
    keys.sort_unstable();
    keys.dedup();
    let (mut tags, mut left_out) = (Vec::new(), Vec::new());
    for key in keys {
        match sized(key, given)? {
            Some(tag) => tags.push(tag),
            None => left_out.push(leave(key, LeftOutReason::NoSize)),
        }
    }
    let mut sightings = Vec::new();
    for (photo, PhotoTags { seen, .. }) in photos.iter().enumerate() {
        for s in seen.iter().filter(|s| is_usable(s, seen)) {
            let Some(tag) = tags.iter().position(|t| t.key == (s.family, s.id)) else {
                continue;
            };
            let branches = planar::branches(tags[tag].size_mm, &s.corners_px, camera);
            if !branches.is_empty() {
                sightings.push(Sighting {
                    tag,
                    photo,
                    corners_px: s.corners_px,
                    branches,
                });
            }
        }
    }
    let net = TagNetwork {
        camera,
        tags,
        photos: photos.len(),
        sightings,
    };
    for (t, tag) in net.tags.iter().enumerate() {
        if tag.fixed.is_none() && net.of_tag(t).next().is_none() {
            left_out.push(leave(tag.key, LeftOutReason::NeverWhole));
        }
    }
    Ok((net, left_out))
}

fn is_usable(s: &SeenTag, seen: &[SeenTag]) -> bool {
    let times = seen
        .iter()
        .filter(|other| (other.family, other.id) == (s.family, s.id))
        .count();
    s.is_whole && times == 1 && s.corners_px.iter().flatten().all(|v| v.is_finite())
}

/// The size of a tag, and its pose when it is fixed.
fn sized(key: TagKey, given: &SurveyInput) -> Result<Option<SizedTag>, SurveyError> {
    let (family, id) = key;
    let stated = given
        .sizes
        .filter(|_| family == given.family)
        .and_then(|sizes| sizes.of(id));
    let known = given.scene.tag(family, id);
    if !given.fixed.contains(&key) {
        let size = stated.or(known.map(|t| t.size_mm));
        return Ok(size.map(|size_mm| SizedTag {
            key,
            size_mm,
            fixed: None,
        }));
    }
    let known = known.ok_or(SurveyError::FixedUnknown { id })?;
    match stated {
        Some(given_mm) if given_mm != known.size_mm => Err(SurveyError::TwoSizes {
            id,
            scene_mm: known.size_mm,
            given_mm,
        }),
        _ => Ok(Some(SizedTag {
            key,
            size_mm: known.size_mm,
            fixed: Some(known.pose()),
        })),
    }
}

fn check_connected(net: &TagNetwork) -> Result<(), SurveyError> {
    let photos = (0..net.photos).filter(|p| net.of_photo(*p).next().is_some()).count();
    if photos < 2 {
        return Err(SurveyError::TooFewPhotos { photos });
    }
    let ids = |tags: &mut dyn Iterator<Item = usize>| tags.map(|t| net.tags[t].key.1).collect::<Vec<u32>>();
    let fixed = |t: &usize| net.tags[*t].fixed.is_some();
    if !net.sightings.iter().any(|s| fixed(&s.tag)) {
        let ids = ids(&mut (0..net.tags.len()).filter(fixed));
        return Err(SurveyError::NoFixedTag { ids });
    }
    if net.sightings.iter().all(|s| fixed(&s.tag)) {
        return Err(SurveyError::NothingToSurvey);
    }
    let groups = net.groups();
    if groups.len() > 1 {
        let all = groups.iter().map(|g| ids(&mut g.iter().copied())).collect();
        return Err(SurveyError::Disconnected { all });
    }
    Ok(())
}

/// Leaves out the tags that the photos disagree about, one after the other, and adjusts the rest anew each time.
fn without_suspects<'a>(
    mut net: TagNetwork<'a>,
    poses: &mut Poses,
    photos: &[PhotoTags],
    left_out: &mut Vec<LeftOutTag>,
) -> Result<TagNetwork<'a>, SurveyError> {
    let names = |numbers: &[usize]| numbers.iter().map(|p| photos[*p].name.clone()).collect::<Vec<_>>();
    let all = net.sightings.len();
    loop {
        let (rms_px, limit_px) = (suspects::noise_px(&net, poses), MAX_NOISE_DEG / net.camera.deg_per_px());
        if rms_px > limit_px || 3 * net.sightings.len() < 2 * all {
            return Err(SurveyError::Disagree { rms_px, limit_px });
        }
        let limit_px = suspects::limit_px(&net, rms_px);
        let Some((tag, fault)) = suspects::worst(&net, poses, limit_px) else {
            return Ok(net);
        };
        let SizedTag { key, size_mm, fixed } = net.tags[tag].clone();
        let reason = match fault {
            TagFault::BadlySeen { photos } => {
                net.sightings.retain(|s| s.tag != tag || !photos.contains(&s.photo));
                readjust(&net, poses);
                continue;
            }
            TagFault::NotWhereGiven { mm } => {
                let fault = format!("stands about {mm:.1} mm from where the scene says");
                return Err(SurveyError::FixedTag { id: key.1, fault });
            }
            TagFault::Moved { mm, here, there } => LeftOutReason::Moved {
                mm,
                here: names(&here),
                there: names(&there),
            },
            TagFault::WrongSize { fits_mm } => LeftOutReason::WrongSize {
                stated_mm: size_mm,
                fits_mm,
            },
        };
        if fixed.is_some() {
            let fault = reason.to_string();
            return Err(SurveyError::FixedTag { id: key.1, fault });
        }
        left_out.push(leave(key, reason));
        net.sightings.retain(|s| s.tag != tag);
        readjust(&net, poses);
    }
}

fn readjust(net: &TagNetwork, poses: &mut Poses) {
    forget_unseen(net, poses);
    adjust(net, poses, Free::All, grow::rough(net), 50);
}

/// A pose that no sighting supports any more is no pose.
fn forget_unseen(net: &TagNetwork, poses: &mut Poses) {
    for (t, pose) in poses.tags.iter_mut().enumerate() {
        if net.tags[t].fixed.is_none() && net.of_tag(t).next().is_none() {
            *pose = None;
        }
    }
    for (p, pose) in poses.photos.iter_mut().enumerate() {
        if net.of_photo(p).next().is_none() {
            *pose = None;
        }
    }
}

/// Leaves out photos and tags that could be in another pose. A tag that a single photo shows stays when that photo excludes its rival;
/// that it has not moved, and has its stated size, nothing checks.
fn without_doubtful<'a>(
    mut net: TagNetwork<'a>,
    poses: &mut Poses,
    photos: &[PhotoTags],
    left_out: &mut Vec<LeftOutTag>,
) -> TagNetwork<'a> {
    adjust(&net, poses, Free::All, Loss::Squared, 50);
    loop {
        // A photo is only as sure as the tags that other photos, or the scene, vouch for.
        let vouched = net.with(|s| net.tags[s.tag].fixed.is_some() || net.of_tag(s.tag).count() > 1);
        let doubtful = |p: &usize| net.of_photo(*p).next().is_some() && photo_has_rival(&vouched, poses, *p);
        if let Some(photo) = (0..net.photos).find(doubtful) {
            net.sightings.retain(|s| s.photo != photo);
        } else {
            let free = |t: &usize| net.tags[*t].fixed.is_none() && net.of_tag(*t).next().is_some();
            let reason = |t: usize| {
                let mut seen = net.of_tag(t);
                match (seen.next(), seen.next()) {
                    (Some(only), None) => {
                        let is_frontal = tilt_deg(only, poses).is_none_or(|tilt| tilt < MIN_LONE_TILT_DEG);
                        let is_doubtful = is_frontal || tag_has_rival(&net, poses, t, MIN_LONE_RIVAL_RATIO);
                        is_doubtful.then(|| LeftOutReason::SeenOnce {
                            photo: photos[only.photo].name.clone(),
                        })
                    }
                    _ => tag_has_rival(&net, poses, t, MIN_RIVAL_RATIO).then_some(LeftOutReason::Ambiguous),
                }
            };
            let doubtful = (0..net.tags.len()).filter(free).find_map(|t| Some((t, reason(t)?)));
            let Some((tag, reason)) = doubtful else { break };
            left_out.push(leave(net.tags[tag].key, reason));
            net.sightings.retain(|s| s.tag != tag);
        }
        forget_unseen(&net, poses);
        adjust(&net, poses, Free::All, Loss::Squared, 50);
    }
    // What was only seen in photos that are left out.
    for (t, tag) in net.tags.iter().enumerate() {
        let known = left_out.iter().any(|l| (l.family, l.id) == tag.key);
        if tag.fixed.is_none() && !known && net.of_tag(t).next().is_none() {
            left_out.push(leave(tag.key, LeftOutReason::Ambiguous));
        }
    }
    net
}

/// True when a different pose of a photo leaves almost as little; also when nothing vouches for it.
fn photo_has_rival(vouched: &TagNetwork, poses: &Poses, photo: usize) -> bool {
    let own = vouched.with(|s| s.photo == photo);
    if own.sightings.is_empty() {
        return true;
    }
    let candidates = grow::photo_candidates(&own, poses, photo);
    has_rival(
        &own,
        poses,
        |p| &mut p.photos[photo],
        Free::Photo(photo),
        candidates,
        MIN_RIVAL_RATIO,
    )
}

/// True when a different pose of a tag leaves less than so many times as much.
fn tag_has_rival(net: &TagNetwork, poses: &Poses, tag: usize, ratio: f64) -> bool {
    let own = net.with(|s| s.tag == tag);
    let candidates = grow::tag_candidates(&own, poses, tag);
    has_rival(&own, poses, |p| &mut p.tags[tag], Free::Tag(tag), candidates, ratio)
}

/// The angle between a tag's normal and the line of sight to its centre.
fn tilt_deg(s: &Sighting, poses: &Poses) -> Option<f64> {
    let camera_tag = poses.camera_tag(s)?;
    let normal = camera_tag.rotation * nalgebra::Vector3::z();
    Some(normal.angle(&-camera_tag.translation.vector).to_degrees())
}

fn has_rival(
    own: &TagNetwork,
    poses: &Poses,
    place: impl Fn(&mut Poses) -> &mut Option<Rigid>,
    free: Free,
    candidates: Vec<Rigid>,
    ratio: f64,
) -> bool {
    let mut best = poses.clone();
    let left = adjust(own, &mut best, free, Loss::Squared, 30);
    let Some(pose) = *place(&mut best) else { return true };
    let floor = 4.0 * own.sightings.len() as f64 * NOISE_FLOOR_PX.powi(2);
    candidates.into_iter().any(|start| {
        let mut other = poses.clone();
        *place(&mut other) = Some(start);
        let rival = adjust(own, &mut other, free, Loss::Squared, 30);
        let different = place(&mut other).is_some_and(|other| grow::is_different(&other, &pose));
        different && rival < ratio.powi(2) * left.max(floor)
    })
}

/// The least-squares result with its σ.
fn finished(
    mut net: TagNetwork,
    mut poses: Poses,
    moved_px: f64,
    photos: &[PhotoTags],
    given: &SurveyInput,
    mut left_out: Vec<LeftOutTag>,
) -> Result<Survey, SurveyError> {
    let noise_px = suspects::noise_px(&net, &poses);
    let shared = edges::fit(&mut net, &mut poses, Loss::Squared, moved_px, noise_px);
    let net = &net;
    let left = adjust(net, &mut poses, Free::All, Loss::Squared, 100);
    let numbers = 8 * net.sightings.len();
    let spare = numbers
        .checked_sub(adjust::unknowns(net, &poses))
        .filter(|spare| *spare > 0);
    let spare = spare.ok_or(SurveyError::Undetermined)?;
    let noise_px = (left / spare as f64).sqrt();
    // Whatever the steps before have missed ends here, not in the file.
    let rms_px = suspects::largest_rms_px(net, &poses);
    let limit_px = 2.0 * suspects::limit_px(net, suspects::noise_px(net, &poses));
    if rms_px > limit_px {
        return Err(SurveyError::Disagree { rms_px, limit_px });
    }
    let covariances = adjust::covariances(net, &poses).ok_or(SurveyError::Undetermined)?;
    let (mut tags, mut reports) = (Vec::new(), Vec::new());
    for (t, sized) in net.tags.iter().enumerate() {
        let (family, id) = sized.key;
        let known = given.scene.tag(family, id);
        let tag = match (sized.fixed, poses.tags[t], &covariances[t]) {
            (Some(_), ..) => known.cloned(),
            (None, Some(pose), Some(covariance)) => {
                let rate = shared.by_tag[t].unwrap_or_default();
                // Per px² of noise, like the covariance.
                let shared_px2 = shared.variance + (edges::LEFT_PX / noise_px.max(1e-6)).powi(2);
                let covariance = covariance + shared_px2 * rate * rate.transpose();
                let worst = |rows: usize| {
                    let block = covariance.fixed_view::<3, 3>(rows, rows).into_owned();
                    noise_px * block.symmetric_eigenvalues().max().max(0.0).sqrt()
                };
                let sigma = TagSigma {
                    mm: worst(0),
                    deg: worst(3).to_degrees(),
                };
                Some(Tag {
                    sigma: Some(sigma),
                    ..standing(sized, &pose)
                })
            }
            _ => None,
        };
        let Some(tag) = tag else { continue };
        reports.push(TagReport {
            family,
            id,
            is_fixed: sized.fixed.is_some(),
            photos: net.of_tag(t).count(),
            shift: known.map(|known| shift(&known.pose(), &tag.pose())),
        });
        tags.push(tag);
    }
    left_out.sort_by_key(|l| (l.family, l.id));
    Ok(Survey {
        scene: Scene {
            tags,
            ..given.scene.clone()
        },
        tags: reports,
        left_out,
        photos: photos
            .iter()
            .enumerate()
            .map(|(p, tags)| photo_report(net, &poses, p, tags))
            .collect(),
        noise_px,
        edge_shift_px: shared.moved_px,
    })
}

fn photo_report(net: &TagNetwork, poses: &Poses, photo: usize, tags: &PhotoTags) -> PhotoReport {
    let own = net.with(|s| s.photo == photo);
    let mut used: Vec<u32> = own.sightings.iter().map(|s| net.tags[s.tag].key.1).collect();
    used.sort_unstable();
    let is_used = |s: &SeenTag| own.sightings.iter().any(|o| net.tags[o.tag].key == (s.family, s.id));
    let mut ignored_tags: Vec<u32> = tags.seen.iter().filter(|s| !is_used(s)).map(|s| s.id).collect();
    ignored_tags.sort_unstable();
    ignored_tags.dedup();
    let corners = 4.0 * used.len() as f64;
    let rms_px = (adjust::cost(&own, poses, Loss::Squared) / corners).sqrt();
    PhotoReport {
        name: tags.name.clone(),
        pose: poses.photos[photo],
        rms_px: (!used.is_empty()).then_some(rms_px),
        tags: used,
        ignored_tags,
    }
}

fn standing(tag: &SizedTag, pose: &Rigid) -> Tag {
    let axes = pose.rotation.to_rotation_matrix();
    Tag {
        id: tag.key.1,
        family: tag.key.0,
        size_mm: tag.size_mm,
        centre_mm: pose.translation.vector.into(),
        right: axes.matrix().column(0).into_owned(),
        up: axes.matrix().column(1).into_owned(),
        sigma: None,
    }
}

/// How far two poses are apart, mm and degrees.
pub fn shift(a: &Rigid, b: &Rigid) -> (f64, f64) {
    let mm = (a.translation.vector - b.translation.vector).norm();
    (mm, a.rotation.angle_to(&b.rotation).to_degrees())
}

fn leave((family, id): TagKey, reason: LeftOutReason) -> LeftOutTag {
    LeftOutTag { family, id, reason }
}
