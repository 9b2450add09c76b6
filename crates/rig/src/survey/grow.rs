//! First poses for the adjustment: from one photo of a fixed tag, photo by photo, every planar branch a candidate.

use super::adjust::{Free, Loss, adjust, cost};
use super::network::{Poses, TagNetwork};
use super::residual::squared_px;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;

/// The loss's scale while poses are still rough.
const ROUGH_DEG: f64 = 0.1;

/// A pose turned by more than this is another pose.
const SAME_TURN_DEG: f64 = 3.0;

/// Photos of fixed tags that are tried as the first one; two poses of each.
const FIRST_PHOTOS: usize = 4;

/// A whole arrangement that explains the photos must leave this many times less than a different one.
const MIN_RIVAL_COST: f64 = 4.0;

pub(super) fn rough(camera: &Camera) -> Loss {
    Loss::Cauchy {
        scale_px: ROUGH_DEG / camera.deg_per_px(),
    }
}

pub(super) fn is_different(a: &Rigid, b: &Rigid) -> bool {
    a.rotation.angle_to(&b.rotation).to_degrees() > SAME_TURN_DEG
}

/// Two arrangements that explain the photos almost equally well.
pub(super) struct TwoArrangements;

/// Every start is grown to the end, and the arrangement that leaves least is taken; a photo pose in it that is different in
/// another arrangement that leaves almost as little is a doubt about all of them.
pub(super) fn grown(net: &TagNetwork, camera: &Camera) -> Result<Poses, TwoArrangements> {
    let mut found: Vec<(f64, Poses)> = starts(net, camera)
        .into_iter()
        .map(|(photo, pose)| grow(net, photo, pose, camera))
        .collect();
    // A start that reaches fewer poses has left less only because it explains less.
    let reached = |p: &Poses| p.tags.iter().chain(&p.photos).flatten().count();
    found.sort_by(|a, b| {
        (reached(&b.1), a.0)
            .partial_cmp(&(reached(&a.1), b.0))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let Some((least, best)) = found.first() else {
        return Err(TwoArrangements);
    };
    let differs = |p: &Poses| {
        let mut pairs = p
            .photos
            .iter()
            .zip(&best.photos)
            .filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
        pairs.all(|(a, b)| is_different(a, b))
    };
    // Below this, either of two costs is noise.
    let floor = 0.01 * 8.0 * net.sightings.len() as f64;
    let rival = found
        .iter()
        .filter(|(_, p)| differs(p))
        .map(|(c, _)| *c)
        .fold(f64::INFINITY, f64::min);
    if rival < MIN_RIVAL_COST * least.max(floor) {
        return Err(TwoArrangements);
    }
    Ok(best.clone())
}

/// Photos of the most and largest fixed tags, each with its best pose and the best different one.
fn starts(net: &TagNetwork, camera: &Camera) -> Vec<(usize, Rigid)> {
    let fixed = net.with(|s| net.tags[s.tag].fixed.is_some());
    let mut photos: Vec<usize> = (0..net.photos)
        .filter(|p| fixed.of_photo(*p).next().is_some())
        .collect();
    let size = |p: &usize| fixed.of_photo(*p).map(|s| area_px(&s.corners_px)).sum::<f64>();
    photos.sort_by(|a, b| size(b).total_cmp(&size(a)));
    photos.truncate(FIRST_PHOTOS);
    let mut starts = Vec::new();
    for photo in photos {
        let mut poses = photo_candidates(&fixed, &known(net), photo);
        poses.sort_by(|a, b| {
            let of = |pose: &Rigid| photo_cost(&fixed, &known(net), photo, pose, camera);
            of(a).total_cmp(&of(b))
        });
        let Some(best) = poses.first().copied() else { continue };
        let rival = poses.iter().find(|p| is_different(p, &best));
        starts.extend([Some(&best), rival].into_iter().flatten().map(|pose| (photo, *pose)));
    }
    starts
}

/// Nothing is known but the fixed tags.
fn known(net: &TagNetwork) -> Poses {
    Poses {
        tags: net.tags.iter().map(|t| t.fixed).collect(),
        photos: vec![None; net.photos],
    }
}

fn grow(net: &TagNetwork, photo: usize, pose: Rigid, camera: &Camera) -> (f64, Poses) {
    let mut poses = known(net);
    poses.photos[photo] = Some(pose);
    let (mut placed, mut adjust_at) = (1, 2);
    while place_tags(net, &mut poses, camera) | place_photo(net, &mut poses, camera) {
        placed += 1;
        if placed >= adjust_at {
            settle(net, &mut poses, camera, 5);
            adjust_at = placed + 1 + placed / 4; // each adjustment is dearer, so they grow rarer
        }
    }
    // What one adjustment puts right may show another tag or photo the way out of its wrong branch.
    let mut left = f64::INFINITY;
    for _ in 0..10 {
        let now = settle(net, &mut poses, camera, 50);
        if now > 0.999 * left {
            break;
        }
        left = now;
    }
    (cost(net, &poses, rough(camera), camera), poses)
}

/// Lets every tag and photo take a better candidate, then adjusts all.
fn settle(net: &TagNetwork, poses: &mut Poses, camera: &Camera, steps: usize) -> f64 {
    for tag in (0..net.tags.len()).filter(|t| net.tags[*t].fixed.is_none()) {
        if poses.tags[tag].is_some() {
            poses.tags[tag] = best_tag(net, poses, tag, camera);
        }
    }
    for photo in 0..net.photos {
        if poses.photos[photo].is_some() {
            poses.photos[photo] = best_photo(net, poses, photo, camera);
        }
    }
    adjust(net, poses, Free::All, rough(camera), camera, steps)
}

/// Places each tag that a placed photo shows; true when there was one.
fn place_tags(net: &TagNetwork, poses: &mut Poses, camera: &Camera) -> bool {
    let mut any = false;
    for tag in 0..net.tags.len() {
        if poses.tags[tag].is_none() {
            poses.tags[tag] = best_tag(net, poses, tag, camera);
            any |= poses.tags[tag].is_some();
        }
    }
    any
}

/// Places the photo that shows the most placed tags; true when there was one.
fn place_photo(net: &TagNetwork, poses: &mut Poses, camera: &Camera) -> bool {
    let shows = |p: &usize| net.of_photo(*p).filter(|s| poses.tags[s.tag].is_some()).count();
    let waiting = (0..net.photos).filter(|p| poses.photos[*p].is_none() && shows(p) > 0);
    let Some(photo) = waiting.max_by_key(|p| (shows(p), std::cmp::Reverse(*p))) else {
        return false;
    };
    poses.photos[photo] = best_photo(net, poses, photo, camera);
    if poses.photos[photo].is_some() {
        adjust(net, poses, Free::Photo(photo), rough(camera), camera, 20);
    }
    poses.photos[photo].is_some()
}

/// The candidate pose of a tag, or the one it has, that leaves least in the placed photos.
fn best_tag(net: &TagNetwork, poses: &Poses, tag: usize, camera: &Camera) -> Option<Rigid> {
    let candidates = tag_candidates(net, poses, tag).into_iter().chain(poses.tags[tag]);
    least(candidates, |pose| tag_cost(net, poses, tag, pose, camera))
}

fn best_photo(net: &TagNetwork, poses: &Poses, photo: usize, camera: &Camera) -> Option<Rigid> {
    let candidates = photo_candidates(net, poses, photo)
        .into_iter()
        .chain(poses.photos[photo]);
    least(candidates, |pose| photo_cost(net, poses, photo, pose, camera))
}

fn least(candidates: impl Iterator<Item = Rigid>, cost: impl Fn(&Rigid) -> f64) -> Option<Rigid> {
    candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// `T_model_tag` by each branch in each placed photo.
pub(super) fn tag_candidates(net: &TagNetwork, poses: &Poses, tag: usize) -> Vec<Rigid> {
    let of = |s: &super::network::Sighting| {
        let photo = poses.photos[s.photo]?;
        Some(
            s.branches
                .iter()
                .map(move |branch| photo.inverse() * branch)
                .collect::<Vec<_>>(),
        )
    };
    net.of_tag(tag).filter_map(of).flatten().collect()
}

/// `T_camera_model` by each branch of each placed tag.
pub(super) fn photo_candidates(net: &TagNetwork, poses: &Poses, photo: usize) -> Vec<Rigid> {
    let of = |s: &super::network::Sighting| {
        let tag = poses.tags[s.tag]?;
        Some(
            s.branches
                .iter()
                .map(move |branch| branch * tag.inverse())
                .collect::<Vec<_>>(),
        )
    };
    net.of_photo(photo).filter_map(of).flatten().collect()
}

fn tag_cost(net: &TagNetwork, poses: &Poses, tag: usize, pose: &Rigid, camera: &Camera) -> f64 {
    let size_mm = net.tags[tag].size_mm;
    let placed = net.of_tag(tag).filter_map(|s| Some((s, poses.photos[s.photo]?)));
    placed
        .map(|(s, photo)| sighting_cost(&(photo * pose), size_mm, &s.corners_px, camera))
        .sum()
}

fn photo_cost(net: &TagNetwork, poses: &Poses, photo: usize, pose: &Rigid, camera: &Camera) -> f64 {
    let placed = net.of_photo(photo).filter_map(|s| Some((s, poses.tags[s.tag]?)));
    placed
        .map(|(s, tag)| sighting_cost(&(pose * tag), net.tags[s.tag].size_mm, &s.corners_px, camera))
        .sum()
}

fn sighting_cost(camera_tag: &Rigid, size_mm: f64, seen_px: &[[f64; 2]; 4], camera: &Camera) -> f64 {
    let loss = rough(camera);
    squared_px(camera_tag, size_mm, seen_px, camera)
        .iter()
        .map(|e| loss.cost(*e))
        .sum()
}

/// Area of a tag in the image, px² (shoelace formula).
fn area_px(c: &[[f64; 2]; 4]) -> f64 {
    let cross = |i: usize| c[i][0] * c[(i + 1) % 4][1] - c[(i + 1) % 4][0] * c[i][1];
    (0..4).map(cross).sum::<f64>().abs() / 2.0
}
