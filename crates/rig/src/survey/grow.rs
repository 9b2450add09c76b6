//! First poses for the adjustment: from one photo of a fixed tag, photo by photo, every planar branch a candidate.

use super::adjust::{Free, Loss, adjust, cost};
use super::network::{Poses, Sighting, TagNetwork};
use super::residual::squared_px;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::locate::area_px;

/// The loss's scale while poses are still rough.
const ROUGH_DEG: f64 = 0.1;

/// A pose turned by more than this is another pose.
const SAME_TURN_DEG: f64 = 3.0;

/// Photos of fixed tags that are tried as the first one; two poses of each.
const FIRST_PHOTOS: usize = 4;

/// A whole arrangement that explains the photos must leave this many times less than a different one.
const MIN_RIVAL_COST: f64 = 4.0;

pub(super) fn rough(net: &TagNetwork) -> Loss {
    Loss::Cauchy {
        scale_px: ROUGH_DEG / net.camera.deg_per_px(),
    }
}

pub(super) fn is_different(a: &Rigid, b: &Rigid) -> bool {
    a.rotation.angle_to(&b.rotation).to_degrees() > SAME_TURN_DEG
}

/// Two arrangements that explain the photos almost equally well.
pub(super) struct TwoArrangements;

/// Every start is grown to the end, and the arrangement that leaves least is taken; a photo pose in it that is different in
/// another arrangement that leaves almost as little is a doubt about all of them.
pub(super) fn grown(net: &TagNetwork) -> Result<Poses, TwoArrangements> {
    let starts = starts(net).into_iter();
    let mut found: Vec<(f64, Poses)> = starts.map(|(photo, pose)| grow(net, photo, pose)).collect();
    // A start that reaches fewer poses has left less only because it explains less.
    let reached = |p: &Poses| p.tags.iter().chain(&p.photos).flatten().count();
    found.sort_by(|(cost_a, a), (cost_b, b)| reached(b).cmp(&reached(a)).then(cost_a.total_cmp(cost_b)));
    let Some((least, best)) = found.first() else {
        return Err(TwoArrangements);
    };
    let differs = |p: &Poses| {
        let pairs = p.photos.iter().zip(&best.photos);
        let mut pairs = pairs.filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
        pairs.all(|(a, b)| is_different(a, b))
    };
    // Below this, either of two costs is noise.
    let floor = 0.01 * 8.0 * net.sightings.len() as f64;
    let rivals = found.iter().filter(|(_, p)| differs(p));
    let rival = rivals.map(|(c, _)| *c).fold(f64::INFINITY, f64::min);
    if rival < MIN_RIVAL_COST * least.max(floor) {
        return Err(TwoArrangements);
    }
    Ok(best.clone())
}

/// Photos of the most and largest fixed tags, each with its best pose and the best different one.
fn starts(net: &TagNetwork) -> Vec<(usize, Rigid)> {
    let fixed = net.with(|s| net.tags[s.tag].fixed.is_some());
    let shows_any = |p: &usize| fixed.of_photo(*p).next().is_some();
    let mut photos: Vec<usize> = (0..net.photos).filter(shows_any).collect();
    let size = |p: &usize| fixed.of_photo(*p).map(|s| area_px(&s.corners_px)).sum::<f64>();
    photos.sort_by(|a, b| size(b).total_cmp(&size(a)));
    photos.truncate(FIRST_PHOTOS);
    let known = known(net);
    let mut starts = Vec::new();
    for photo in photos {
        let cost = |pose: &Rigid| photo_cost(&fixed, &known, photo, pose);
        let mut poses = photo_candidates(&fixed, &known, photo);
        poses.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = poses.first();
        let rival = poses.iter().find(|p| best.is_some_and(|best| is_different(p, best)));
        starts.extend(best.into_iter().chain(rival).map(|pose| (photo, *pose)));
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

fn grow(net: &TagNetwork, photo: usize, pose: Rigid) -> (f64, Poses) {
    let mut poses = known(net);
    poses.photos[photo] = Some(pose);
    let (mut placed, mut adjust_at) = (1, 2);
    while place_tags(net, &mut poses) | place_photo(net, &mut poses) {
        placed += 1;
        if placed >= adjust_at {
            settle(net, &mut poses, 5);
            adjust_at = placed + 1 + placed / 4; // each adjustment is dearer, so they grow rarer
        }
    }
    // What one adjustment puts right may show another tag or photo the way out of its wrong branch.
    let mut left = f64::INFINITY;
    for _ in 0..10 {
        let now = settle(net, &mut poses, 50);
        if now > 0.999 * left {
            break;
        }
        left = now;
    }
    (cost(net, &poses, rough(net)), poses)
}

/// Lets every tag and photo take a better candidate, then adjusts all.
fn settle(net: &TagNetwork, poses: &mut Poses, steps: usize) -> f64 {
    for tag in (0..net.tags.len()).filter(|t| net.tags[*t].fixed.is_none()) {
        if poses.tags[tag].is_some() {
            poses.tags[tag] = best_tag(net, poses, tag);
        }
    }
    for photo in 0..net.photos {
        if poses.photos[photo].is_some() {
            poses.photos[photo] = best_photo(net, poses, photo);
        }
    }
    adjust(net, poses, Free::All, rough(net), steps)
}

/// Places each tag that a placed photo shows; true when there was one.
fn place_tags(net: &TagNetwork, poses: &mut Poses) -> bool {
    let mut any = false;
    for tag in 0..net.tags.len() {
        if poses.tags[tag].is_none() {
            poses.tags[tag] = best_tag(net, poses, tag);
            any |= poses.tags[tag].is_some();
        }
    }
    any
}

/// Places the photo that shows the most placed tags; true when there was one.
fn place_photo(net: &TagNetwork, poses: &mut Poses) -> bool {
    let shows = |p: &usize| net.of_photo(*p).filter(|s| poses.tags[s.tag].is_some()).count();
    let waiting = (0..net.photos).filter(|p| poses.photos[*p].is_none() && shows(p) > 0);
    let Some(photo) = waiting.max_by_key(|p| (shows(p), std::cmp::Reverse(*p))) else {
        return false;
    };
    poses.photos[photo] = best_photo(net, poses, photo);
    if poses.photos[photo].is_some() {
        adjust(net, poses, Free::Photo(photo), rough(net), 20);
    }
    poses.photos[photo].is_some()
}

/// The candidate pose of a tag, or the one it has, that leaves least in the placed photos.
fn best_tag(net: &TagNetwork, poses: &Poses, tag: usize) -> Option<Rigid> {
    let candidates = tag_candidates(net, poses, tag).into_iter().chain(poses.tags[tag]);
    least(candidates, |pose| tag_cost(net, poses, tag, pose))
}

/// The candidate pose of a photo, or the one it has, that leaves least of the placed tags.
fn best_photo(net: &TagNetwork, poses: &Poses, photo: usize) -> Option<Rigid> {
    let candidates = photo_candidates(net, poses, photo).into_iter();
    least(candidates.chain(poses.photos[photo]), |pose| {
        photo_cost(net, poses, photo, pose)
    })
}

fn least(candidates: impl Iterator<Item = Rigid>, cost: impl Fn(&Rigid) -> f64) -> Option<Rigid> {
    candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// `T_model_tag` by each branch in each placed photo.
pub(super) fn tag_candidates(net: &TagNetwork, poses: &Poses, tag: usize) -> Vec<Rigid> {
    let placed = net
        .of_tag(tag)
        .filter_map(|s| Some((s, poses.photos[s.photo]?.inverse())));
    placed
        .flat_map(|(s, photo)| s.branches.iter().map(move |branch| photo * branch))
        .collect()
}

/// `T_camera_model` by each branch of each placed tag.
pub(super) fn photo_candidates(net: &TagNetwork, poses: &Poses, photo: usize) -> Vec<Rigid> {
    let placed = net
        .of_photo(photo)
        .filter_map(|s| Some((s, poses.tags[s.tag]?.inverse())));
    placed
        .flat_map(|(s, tag)| s.branches.iter().map(move |branch| branch * tag))
        .collect()
}

fn tag_cost(net: &TagNetwork, poses: &Poses, tag: usize, pose: &Rigid) -> f64 {
    let placed = net.of_tag(tag).filter_map(|s| Some((s, poses.photos[s.photo]?)));
    placed.map(|(s, photo)| sighting_cost(net, s, &(photo * pose))).sum()
}

fn photo_cost(net: &TagNetwork, poses: &Poses, photo: usize, pose: &Rigid) -> f64 {
    let placed = net.of_photo(photo).filter_map(|s| Some((s, poses.tags[s.tag]?)));
    placed.map(|(s, tag)| sighting_cost(net, s, &(pose * tag))).sum()
}

fn sighting_cost(net: &TagNetwork, s: &Sighting, camera_tag: &Rigid) -> f64 {
    let loss = rough(net);
    let squared = squared_px(camera_tag, net.tags[s.tag].size_mm, &s.corners_px, net.camera);
    squared.iter().map(|e| loss.cost(*e)).sum()
}
