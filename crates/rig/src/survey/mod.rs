//! Survey of tags that were placed by hand: their poses, from photos and the tags' sizes alone.
//!
//! Some tags are *fixed*: their poses in the model frame are given (a printed ground mat, or one origin tag). All other tags and
//! all photos are adjusted together (bundle adjustment) around them.

mod adjust;
mod detect;
mod edges;
mod grow;
mod lens;
mod lens_numbers;
mod network;
mod problem;
pub mod residual;
mod sizes;
mod suspects;

use nalgebra::Matrix6;

use adjust::{Free, Loss, adjust};
use network::{Node, Poses, Sighting, SizedTag, TINY, TagKey, TagNetwork};
use scaleproof_core::geometry::Rigid;
use scaleproof_core::message::{bail, message};
use scaleproof_core::spelling::list;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::{expected_px2, planar_branches};
use scaleproof_pose::scene::{Scene, Tag, TagFamily, TagSigma, corners_in_tag_mm};
use scaleproof_pose::tags::SeenTag;
use suspects::TagFault;

pub use detect::{PhotoTags, SurveyPhotos, detect_tags};
pub use edges::outwards;
pub use problem::{LeftOutReason, SurveyError};
pub use sizes::Sizes;

/// Largest angle of noise: more comes from the wrong camera, or wrong sizes.
const MAX_NOISE_DEG: f64 = 0.1;

/// Number of σ of a corner coordinate by whose square the cost must rise to exclude another pose of a tag or photo.
const MIN_RIVAL_SIGMAS: f64 = 6.0;

/// Least noise when two poses are compared, px: less is luck.
const NOISE_FLOOR_PX: f64 = 0.1;

/// Number of residuals that the expected noise ([`expected_px2`]) weighs for each tag: as many as a sighting has, since the bend of its paper is one
/// draw, however many photos show it. In a room of real paper (`swatbotics`) the residuals are 0.8 times what is expected, yet a chain of tags is off
/// by as much as expected.
const NOISE_WEIGHT: f64 = 8.0;

/// Input of a survey.
#[derive(Debug, Clone, Copy)]
pub struct SurveyInput<'a> {
    /// Model, bins, and the fixed tags' poses; other tags only lend their sizes.
    pub scene: &'a Scene,
    pub fixed: &'a [(TagFamily, u32)],
    /// Sizes of the tags of `family`; they go before those of the scene.
    pub sizes: Option<&'a Sizes>,
    pub family: TagFamily,
}

#[derive(Debug, Clone)]
pub struct Survey {
    /// The given model and bins; the fixed tags as given, then the surveyed ones with their σ, by family and id.
    pub scene: Scene,
    pub tags: Vec<TagReport>,
    pub left_out: Vec<LeftOutTag>,
    /// Reports on the photos, in the order given.
    pub photos: Vec<PhotoReport>,
    /// σ of a corner coordinate by the residuals, px.
    pub noise_px: f64,
    /// Distance by which all tag edges were found too far in, px; taken out of the result.
    pub edge_shift_px: f64,
    /// Largest move of a tag's corner by the lens that the photos fit, against the given camera, px; `None` where the given one fits.
    pub lens_px: Option<f64>,
}

/// A tag that stands in the scene.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[schemars(rename = "TagJson")]
pub struct TagReport {
    /// As in scene.toml, like family, size, pose and their standard deviations, which fixed tags lack.
    pub id: u32,
    pub family: TagFamily,
    pub size_mm: f64,
    #[serde(rename = "fixed")]
    pub is_fixed: bool,
    /// Photos that its pose rests on.
    pub photos: usize,
    pub centre_mm: [f64; 3],
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub sigma_mm: Option<f64>,
    pub sigma_deg: Option<f64>,
    /// From the pose in the given scene, when it has one; so is the next.
    pub shift_mm: Option<f64>,
    pub shift_deg: Option<f64>,
    /// Cautions about it: `one_photo`, a single photo shows it.
    pub cautions: Vec<&'static str>,
}

/// A seen tag that is not in the surveyed scene.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutTag {
    pub family: TagFamily,
    pub id: u32,
    pub reason: LeftOutReason,
}

/// Contribution of one photo to a survey.
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
    /// Reprojection error of the corners used, root mean square; `null` where no tag is used.
    pub rms_px: Option<f64>,
}

/// Surveys the tags that the photos show.
///
/// Both planar branches of every sighting (IPPE: Collins & Bartoli 2014) are candidates for a start, photo by photo, and loops are closed by
/// adjusting all poses together (`grow.rs`), each corner weighed by its expected noise, with one shift that all tag edges share (`edges.rs`).
/// Tags that the photos disagree about by more than the drift of the whole explains are named and left out (`suspects.rs`). The rest is adjusted once
/// more by least squares, whose covariance, scaled by the residuals, gives each σ.
pub fn survey(photos: &[PhotoTags], given: &SurveyInput, camera: &Camera) -> Result<Survey, SurveyError> {
    let (mut net, mut left_out) = network(photos, given, camera)?;
    check_connected(&net)?;
    let mut poses = grow::grown(&net).ok_or(SurveyError::TwoArrangements)?;
    let (noise_px, rough) = (suspects::noise_px(&net, &poses), grow::rough(&net));
    let shared = edges::fit(&mut net, &mut poses, rough, 0.0, noise_px);
    if lens::fit(&mut net, &mut poses, camera, rough, noise_px).is_some() {
        grow::close(&net, &mut poses);
    }
    let net = without_suspects(net, &mut poses, photos, &mut left_out)?;
    let net = without_doubtful(net, &mut poses, photos, &mut left_out);
    check_connected(&net)?;
    finished((net, camera), poses, shared.moved_px, photos, given, left_out)
}

/// Returns the usable sightings, whole tags of known size that are seen once in the photo, and the tags without one.
fn network(
    photos: &[PhotoTags],
    given: &SurveyInput,
    camera: &Camera,
) -> Result<(TagNetwork, Vec<LeftOutTag>), SurveyError> {
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
            let branches = branches(tags[tag].size_mm, &s.corners_px, camera);
            if !branches.is_empty() {
                sightings.push(Sighting {
                    tag,
                    photo,
                    corners_px: s.corners_px,
                    branches,
                    weight: expected_px2(&TINY) / expected_px2(&s.corners_px),
                });
            }
        }
    }
    let net = TagNetwork {
        camera: camera.clone(),
        tags,
        photos: photos.len(),
        sightings,
    };
    for (t, tag) in net.tags.iter().enumerate() {
        if tag.fixed.is_none() && !net.is_seen(Node::Tag(t)) {
            left_out.push(leave(tag.key, LeftOutReason::NeverWhole));
        }
    }
    Ok((net, left_out))
}

/// Returns both planar branches, `T_camera_tag`, the better first; none when there is no pose before the camera.
fn branches(size_mm: f64, corners_px: &[[f64; 2]; 4], camera: &Camera) -> Vec<Rigid> {
    let mut found = planar_branches(&corners_in_tag_mm(size_mm), corners_px, camera);
    let rms = |pose: &Rigid| residual::rms_px(residual::squared_px(pose, size_mm, corners_px, camera));
    found.retain(|pose| pose.translation.z > 0.0 && rms(pose) < 100.0);
    found.sort_by(|a, b| rms(a).total_cmp(&rms(b)));
    found
}

fn is_usable(s: &SeenTag, seen: &[SeenTag]) -> bool {
    let is_same = |other: &&SeenTag| (other.family, other.id) == (s.family, s.id);
    let times = seen.iter().filter(is_same).count();
    s.is_whole && times == 1 && s.corners_px.iter().flatten().all(|v| v.is_finite())
}

/// Returns the size of a tag, and its pose when it is fixed; `None` where no size is known.
fn sized(key: TagKey, given: &SurveyInput) -> Result<Option<SizedTag>, SurveyError> {
    let (family, id) = key;
    let sizes = given.sizes.filter(|_| family == given.family);
    let stated = sizes.and_then(|sizes| sizes.size_mm(id));
    let known = given.scene.tag(family, id);
    let scene_mm = known.map(|tag| tag.size_mm);
    let is_fixed = given.fixed.contains(&key);
    if let (true, Some(given_mm), Some(scene_mm)) = (is_fixed, stated, scene_mm)
        && given_mm != scene_mm
    {
        bail!("tag {id} is fixed with {scene_mm} mm in the scene and given with {given_mm} mm"; hint: "correct one of them (‹sizes›)");
    }
    if is_fixed && known.is_none() {
        bail!(
            "tag {id} is fixed but the scene does not say where it stands: add it to the scene file or fix another tag"
        );
    }
    Ok(stated.or(scene_mm).map(|size_mm| SizedTag {
        key,
        size_mm,
        fixed: known.filter(|_| is_fixed).map(Tag::pose),
    }))
}

fn check_connected(net: &TagNetwork) -> Result<(), SurveyError> {
    let photos = (0..net.photos).filter(|p| net.is_seen(Node::Photo(*p))).count();
    if photos < 2 {
        bail!(
            "only {photos} of the photos shows a tag of known size, and a survey compares photos: give at least two, from different sides"
        );
    }
    if !net.sightings.iter().any(|s| net.is_fixed(s.tag)) {
        let fixed = net.tags.iter().filter(|tag| tag.fixed.is_some());
        let ids: Vec<u32> = fixed.map(|tag| tag.key.1).collect();
        bail!(
            "no fixed tag (id {}) is seen whole in any photo, so that nothing ties the others to the model: take a photo that shows one",
            list(&ids)
        );
    }
    if net.sightings.iter().all(|s| net.is_fixed(s.tag)) {
        bail!("no tag to survey is seen in any photo, only fixed ones or none"; hint: "give their sizes with ‹sizes›, and uncover them");
    }
    let groups = net.groups();
    if groups.len() > 1 {
        let ids = |group: &Vec<usize>| list(&group.iter().map(|t| net.tags[*t].key.1).collect::<Vec<_>>());
        bail!(
            "the tags fall into groups that no photo connects ({}): take a photo that shows tags of two groups, for each gap",
            groups.iter().map(ids).collect::<Vec<_>>().join(" | ")
        );
    }
    Ok(())
}

/// Leaves out the tags that the photos disagree about, one after the other, and adjusts the rest again each time.
fn without_suspects(
    mut net: TagNetwork,
    poses: &mut Poses,
    photos: &[PhotoTags],
    left_out: &mut Vec<LeftOutTag>,
) -> Result<TagNetwork, SurveyError> {
    let names = |numbers: &[usize]| numbers.iter().map(|p| photos[*p].name.clone()).collect::<Vec<_>>();
    let all = net.sightings.len();
    loop {
        let (rms_px, limit_px) = (suspects::noise_px(&net, poses), MAX_NOISE_DEG / net.camera.deg_per_px());
        if rms_px > limit_px || 3 * net.sightings.len() < 2 * all {
            return Err(disagreement(rms_px, limit_px));
        }
        let limit = suspects::Limit::new(&net, poses);
        let Some((tag, fault)) = suspects::worst(&net, poses, limit) else {
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
                return Err(fixed_tag(key.1, &fault));
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
            return Err(fixed_tag(key.1, &reason.to_string()));
        }
        left_out.push(leave(key, reason));
        net.sightings.retain(|s| s.tag != tag);
        readjust(&net, poses);
    }
}

fn disagreement(rms_px: f64, limit_px: f64) -> SurveyError {
    message!(
        "the tags disagree by {rms_px:.1} px (limit {limit_px:.1} px): is this another camera, are the sizes wrong, or were many tags moved?"
    )
    .into()
}

fn fixed_tag(id: u32, fault: &str) -> SurveyError {
    message!("fixed tag {id} {fault}, so that the others cannot be tied to it: put it right, or fix another tag").into()
}

fn undetermined() -> SurveyError {
    message!("the photos leave the place of some tag open: take more photos, from different sides").into()
}

fn readjust(net: &TagNetwork, poses: &mut Poses) {
    forget_unseen(net, poses);
    grow::close(net, poses);
}

/// Removes poses that no sighting supports any more.
fn forget_unseen(net: &TagNetwork, poses: &mut Poses) {
    for node in net.free().filter(|node| !net.is_seen(*node)) {
        *poses.pose_mut(node) = None;
    }
}

/// Leaves out photos and tags that could be in another pose. A tag that a single photo shows stays when that photo excludes its rival; nothing checks
/// that it has not moved, and has its stated size.
fn without_doubtful(
    mut net: TagNetwork,
    poses: &mut Poses,
    photos: &[PhotoTags],
    left_out: &mut Vec<LeftOutTag>,
) -> TagNetwork {
    adjust(&net, poses, Free::All, Loss::Squared, 50);
    let noise_px = suspects::noise_px(&net, poses).max(NOISE_FLOOR_PX);
    loop {
        // A photo is only as certain as the tags that other photos, or the scene, confirm.
        let vouched = net.with(|s| net.is_fixed(s.tag) || net.sightings_of(Node::Tag(s.tag)).count() > 1);
        let is_doubtful = |photo: &Node| net.is_seen(*photo) && has_rival(&vouched, poses, *photo, noise_px);
        let doubtful = if let Some(photo) = (0..net.photos).map(Node::Photo).find(is_doubtful) {
            photo
        } else {
            let reason = |t: usize| {
                let mut seen = net.sightings_of(Node::Tag(t));
                let (first, second) = (seen.next()?, seen.next());
                let reason = match second {
                    Some(_) => LeftOutReason::Ambiguous,
                    None => LeftOutReason::SeenOnce {
                        photo: photos[first.photo].name.clone(),
                    },
                };
                has_rival(&net, poses, Node::Tag(t), noise_px).then_some(reason)
            };
            let mut free = (0..net.tags.len()).filter(|t| !net.is_fixed(*t));
            let Some((tag, reason)) = free.find_map(|t| Some((t, reason(t)?))) else {
                break;
            };
            left_out.push(leave(net.tags[tag].key, reason));
            Node::Tag(tag)
        };
        net.sightings.retain(|s| !s.is_of(doubtful));
        forget_unseen(&net, poses);
        adjust(&net, poses, Free::All, Loss::Squared, 50);
    }
    // Tags that were only seen in photos that are left out.
    for (t, tag) in net.tags.iter().enumerate() {
        let known = left_out.iter().any(|l| (l.family, l.id) == tag.key);
        if tag.fixed.is_none() && !known && !net.is_seen(Node::Tag(t)) {
            left_out.push(leave(tag.key, LeftOutReason::Ambiguous));
        }
    }
    net
}

/// Returns true if a different pose of a photo or a tag has hardly more cost, or no sighting confirms it.
fn has_rival(net: &TagNetwork, poses: &Poses, node: Node, noise_px: f64) -> bool {
    let own = net.with(|s| s.is_of(node));
    if own.sightings.is_empty() {
        return true;
    }
    let mut best = poses.clone();
    let left = adjust(&own, &mut best, Free::Only(node), Loss::Squared, 30);
    let Some(pose) = *best.pose_mut(node) else { return true };
    grow::candidates(&own, poses, node).into_iter().any(|start| {
        let mut other = poses.clone();
        *other.pose_mut(node) = Some(start);
        let rival = adjust(&own, &mut other, Free::Only(node), Loss::Squared, 30);
        let is_different = other
            .pose_mut(node)
            .is_some_and(|other| grow::is_different(&other, &pose));
        is_different && rival - left < (MIN_RIVAL_SIGMAS * noise_px).powi(2)
    })
}

/// Returns the least-squares result with its σ.
fn finished(
    (mut net, given_camera): (TagNetwork, &Camera),
    mut poses: Poses,
    moved_px: f64,
    photos: &[PhotoTags],
    given: &SurveyInput,
    mut left_out: Vec<LeftOutTag>,
) -> Result<Survey, SurveyError> {
    let noise_px = suspects::noise_px(&net, &poses);
    let shared = edges::fit(&mut net, &mut poses, Loss::Squared, moved_px, noise_px);
    let lens = lens::fit(&mut net, &mut poses, given_camera, Loss::Squared, noise_px);
    let net = &net;
    let left = adjust(net, &mut poses, Free::All, Loss::Squared, 100);
    let numbers = 8 * net.sightings.len();
    let spare = numbers
        .checked_sub(adjust::unknowns(net, &poses))
        .filter(|spare| *spare > 0);
    let spare = spare.ok_or_else(undetermined)?;
    let spare = spare as f64;
    let weight = NOISE_WEIGHT * (0..net.tags.len()).filter(|t| net.is_seen(Node::Tag(*t))).count() as f64;
    let noise_px = ((weight * expected_px2(&TINY) + left) / (weight + spare)).sqrt();
    // Faults that the steps before have missed end here, not in the file.
    let limit = suspects::Limit::new(net, &poses);
    for s in &net.sightings {
        let (rms_px, limit_px) = (suspects::rms(s, net, &poses).unwrap_or(0.0), 2.0 * limit.px(s));
        if rms_px > limit_px {
            return Err(disagreement(rms_px, limit_px));
        }
    }
    let squares = net.sightings.iter().filter_map(|s| suspects::rms(s, net, &poses));
    let seen_px = (squares.map(|rms| 4.0 * rms * rms).sum::<f64>() / spare).sqrt();
    let covariances = adjust::covariances(net, &poses).ok_or_else(undetermined)?;
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
                let by_lens = lens.as_ref().and_then(|lens| Some((lens.by_tag[t]?, lens.covariance)));
                let by_lens = by_lens.map_or_else(Matrix6::zeros, |(by, lens)| by * lens * by.transpose());
                let covariance = covariance + shared_px2 * rate * rate.transpose() + by_lens;
                let worst = |rows: usize| {
                    let block = covariance.fixed_view::<3, 3>(rows, rows).into_owned();
                    noise_px * block.symmetric_eigenvalues().max().max(0.0).sqrt()
                };
                let axes = pose.rotation.to_rotation_matrix();
                Some(Tag {
                    id,
                    family,
                    size_mm: sized.size_mm,
                    centre_mm: pose.translation.vector.into(),
                    right: axes.matrix().column(0).into_owned(),
                    up: axes.matrix().column(1).into_owned(),
                    sigma: Some(TagSigma {
                        mm: worst(0),
                        deg: worst(3).to_degrees(),
                    }),
                })
            }
            _ => None,
        };
        let Some(tag) = tag else { continue };
        let (is_fixed, photos) = (sized.fixed.is_some(), net.sightings_of(Node::Tag(t)).count());
        let shift = known.map(|known| shift(&known.pose(), &tag.pose()));
        // Nothing checks that a tag in one photo has not moved and has its stated size.
        let cautions = (!is_fixed && photos == 1).then_some("one_photo");
        reports.push(TagReport {
            id,
            family,
            size_mm: tag.size_mm,
            is_fixed,
            photos,
            centre_mm: tag.centre_mm.coords.into(),
            right: tag.right.into(),
            up: tag.up.into(),
            sigma_mm: tag.sigma.map(|sigma| sigma.mm),
            sigma_deg: tag.sigma.map(|sigma| sigma.deg),
            shift_mm: shift.map(|(mm, _)| mm),
            shift_deg: shift.map(|(_, deg)| deg),
            cautions: cautions.into_iter().collect(),
        });
        tags.push(tag);
    }
    left_out.sort_by_key(|l| (l.family, l.id));
    let photos = photos.iter().enumerate();
    Ok(Survey {
        scene: Scene {
            tags,
            ..given.scene.clone()
        },
        tags: reports,
        left_out,
        photos: photos.map(|(p, tags)| photo_report(net, &poses, p, tags)).collect(),
        noise_px: seen_px,
        edge_shift_px: shared.moved_px,
        lens_px: lens.map(|_| lens_px(net, &poses, given_camera)),
    })
}

/// Returns the largest distance between the corners' pixels by the fitted camera and by the given one, px.
fn lens_px(net: &TagNetwork, poses: &Poses, given: &Camera) -> f64 {
    let moved = |s: &Sighting| {
        let camera_tag = poses.camera_tag(s)?;
        let corners = corners_in_tag_mm(net.tags[s.tag].size_mm);
        let moved = corners.iter().filter_map(|corner| {
            let point = camera_tag * corner;
            let ([x, y], [u, v]) = (net.camera.project(&point)?, given.project(&point)?);
            Some((x - u).hypot(y - v))
        });
        Some(moved.fold(0.0, f64::max))
    };
    net.sightings.iter().filter_map(moved).fold(0.0, f64::max)
}

fn photo_report(net: &TagNetwork, poses: &Poses, photo: usize, tags: &PhotoTags) -> PhotoReport {
    let own = net.with(|s| s.is_of(Node::Photo(photo)));
    let mut used: Vec<u32> = own.sightings.iter().map(|s| net.tags[s.tag].key.1).collect();
    used.sort_unstable();
    let is_used = |s: &SeenTag| own.sightings.iter().any(|o| net.tags[o.tag].key == (s.family, s.id));
    let mut ignored_tags: Vec<u32> = tags.seen.iter().filter(|s| !is_used(s)).map(|s| s.id).collect();
    ignored_tags.sort_unstable();
    ignored_tags.dedup();
    let squares = own.sightings.iter().filter_map(|s| suspects::rms(s, &own, poses));
    let rms_px = (squares.map(|rms| rms * rms).sum::<f64>() / used.len() as f64).sqrt();
    PhotoReport {
        name: tags.name.clone(),
        pose: poses.photos[photo],
        rms_px: (!used.is_empty()).then_some(rms_px),
        tags: used,
        ignored_tags,
    }
}

/// Returns the distance between two poses, mm and degrees.
pub fn shift(a: &Rigid, b: &Rigid) -> (f64, f64) {
    let mm = (a.translation.vector - b.translation.vector).norm();
    (mm, a.rotation.angle_to(&b.rotation).to_degrees())
}

fn leave((family, id): TagKey, reason: LeftOutReason) -> LeftOutTag {
    LeftOutTag { family, id, reason }
}
