//! First poses for the adjustment, grown from one photo of a fixed tag, photo by photo, every planar branch a candidate.

use super::adjust::{Free, Loss, adjust, cost};
use super::network::{Node, Poses, Sighting, TagNetwork};
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::locate::area_px;

/// Scale of the loss while poses are still rough.
const ROUGH_DEG: f64 = 0.1;

/// Rotation above which a pose is another pose.
const SAME_TURN_DEG: f64 = 3.0;

/// Number of photos of fixed tags that are tried as the first one; two poses of each.
const FIRST_PHOTOS: usize = 4;

/// Least ratio of the cost of a different arrangement to that of the best.
const MIN_RIVAL_COST: f64 = 4.0;

pub(super) fn rough(net: &TagNetwork) -> Loss {
    Loss::Cauchy {
        scale_px: ROUGH_DEG / net.camera.deg_per_px(),
    }
}

pub(super) fn is_different(a: &Rigid, b: &Rigid) -> bool {
    a.rotation.angle_to(&b.rotation).to_degrees() > SAME_TURN_DEG
}

/// Grows every start to the end, and returns the arrangement with the least cost; `None` where another arrangement, of different photo poses, has
/// almost as little, so that all are uncertain.
pub(super) fn grown(net: &TagNetwork) -> Option<Poses> {
    let starts = starts(net).into_iter();
    let mut found: Vec<(f64, Poses)> = starts.map(|(photo, pose)| grow(net, photo, pose)).collect();
    // A start that reaches fewer poses has a lower cost only because it explains less.
    let reached = |p: &Poses| p.tags.iter().chain(&p.photos).flatten().count();
    found.sort_by(|(cost_a, a), (cost_b, b)| reached(b).cmp(&reached(a)).then(cost_a.total_cmp(cost_b)));
    let (least, best) = found.first()?;
    let differs = |p: &Poses| {
        let pairs = p.photos.iter().zip(&best.photos);
        let mut pairs = pairs.filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
        pairs.all(|(a, b)| is_different(a, b))
    };
    // Below this, either of two costs is noise.
    let floor = 0.01 * 8.0 * net.sightings.len() as f64;
    let rivals = found.iter().filter(|(_, p)| differs(p));
    let rival = rivals.map(|(c, _)| *c).fold(f64::INFINITY, f64::min);
    (rival >= MIN_RIVAL_COST * least.max(floor)).then(|| best.clone())
}

/// Returns the photos of the most and largest fixed tags, each with its best pose and the best different one.
fn starts(net: &TagNetwork) -> Vec<(usize, Rigid)> {
    let fixed = net.with(|s| net.is_fixed(s.tag));
    let mut photos: Vec<usize> = (0..net.photos).filter(|p| fixed.is_seen(Node::Photo(*p))).collect();
    let size = |p: &usize| {
        fixed
            .sightings_of(Node::Photo(*p))
            .map(|s| area_px(&s.corners_px))
            .sum::<f64>()
    };
    photos.sort_by(|a, b| size(b).total_cmp(&size(a)));
    photos.truncate(FIRST_PHOTOS);
    let known = known(net);
    let mut starts = Vec::new();
    for photo in photos {
        let cost = |pose: &Rigid| node_cost(&fixed, &known, Node::Photo(photo), pose);
        let mut poses = candidates(&fixed, &known, Node::Photo(photo));
        poses.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = poses.first();
        let rival = poses.iter().find(|p| best.is_some_and(|best| is_different(p, best)));
        starts.extend(best.into_iter().chain(rival).map(|pose| (photo, *pose)));
    }
    starts
}

/// Returns the poses of the fixed tags; no other is known.
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
    // An adjustment may show another tag or photo the way out of its wrong branch.
    let mut left = f64::INFINITY;
    for _ in 0..10 {
        let now = settle(net, &mut poses, 50);
        if now > 0.999 * left {
            break;
        }
        left = now;
    }
    close(net, &mut poses);
    (cost(net, &poses, rough(net)), poses)
}

/// Closes loops. Poses that grew photo by photo along a chain of tags have drifted where its ends meet, and a robust loss attributes all of it to the
/// last sighting. Least squares spreads it over the chain; the loss then narrows again (graduated non-convexity: Blake & Zisserman 1987), so that
/// outliers stay outliers. The result is kept when its cost is lower.
pub(super) fn close(net: &TagNetwork, poses: &mut Poses) {
    let Loss::Cauchy { scale_px } = rough(net) else { return };
    let mut closed = poses.clone();
    for widening in [f64::INFINITY, 16.0, 8.0, 4.0, 2.0] {
        let scale_px = widening * scale_px;
        let loss = if scale_px.is_finite() {
            Loss::Cauchy { scale_px }
        } else {
            Loss::Squared
        };
        adjust(net, &mut closed, Free::All, loss, 30);
    }
    let left = settle(net, &mut closed, 50);
    if left < adjust(net, poses, Free::All, rough(net), 50) {
        *poses = closed;
    }
}

/// Lets every tag and photo take a better candidate, then adjusts all; returns the cost.
fn settle(net: &TagNetwork, poses: &mut Poses, steps: usize) -> f64 {
    for node in net.free() {
        if poses.pose_mut(node).is_some() {
            *poses.pose_mut(node) = best(net, poses, node);
        }
    }
    adjust(net, poses, Free::All, rough(net), steps)
}

/// Places each tag that a placed photo shows; returns true if there was one.
fn place_tags(net: &TagNetwork, poses: &mut Poses) -> bool {
    let mut any = false;
    for tag in 0..net.tags.len() {
        if poses.tags[tag].is_none() {
            poses.tags[tag] = best(net, poses, Node::Tag(tag));
            any |= poses.tags[tag].is_some();
        }
    }
    any
}

/// Places the photo that shows the most placed tags; returns true if there was one.
fn place_photo(net: &TagNetwork, poses: &mut Poses) -> bool {
    let shows = |p: &usize| {
        net.sightings_of(Node::Photo(*p))
            .filter(|s| poses.tags[s.tag].is_some())
            .count()
    };
    let waiting = (0..net.photos).filter(|p| poses.photos[*p].is_none() && shows(p) > 0);
    let Some(photo) = waiting.max_by_key(|p| (shows(p), std::cmp::Reverse(*p))) else {
        return false;
    };
    poses.photos[photo] = best(net, poses, Node::Photo(photo));
    if poses.photos[photo].is_some() {
        adjust(net, poses, Free::Only(Node::Photo(photo)), rough(net), 20);
    }
    poses.photos[photo].is_some()
}

/// Returns the candidate pose of a photo or a tag, or the one it has, with the least cost in the sightings whose other end is placed.
fn best(net: &TagNetwork, poses: &mut Poses, node: Node) -> Option<Rigid> {
    let candidates = candidates(net, poses, node).into_iter().chain(*poses.pose_mut(node));
    let cost = |pose: &Rigid| node_cost(net, poses, node, pose);
    candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)))
}

/// Returns the poses of a photo (`T_camera_model`) or a tag (`T_model_tag`) by each branch of each sighting whose other end is placed.
pub(super) fn candidates(net: &TagNetwork, poses: &Poses, node: Node) -> Vec<Rigid> {
    let by = |s: &Sighting| -> Option<Vec<Rigid>> {
        let branches = s.branches.iter();
        Some(match node {
            Node::Photo(_) => {
                let tag = poses.tags[s.tag]?.inverse();
                branches.map(|branch| branch * tag).collect()
            }
            Node::Tag(_) => {
                let photo = poses.photos[s.photo]?.inverse();
                branches.map(|branch| photo * branch).collect()
            }
        })
    };
    net.sightings_of(node).filter_map(by).flatten().collect()
}

/// Returns the cost of a pose of a photo or a tag in the sightings whose other end is placed.
fn node_cost(net: &TagNetwork, poses: &Poses, node: Node, pose: &Rigid) -> f64 {
    let loss = rough(net);
    let cost = |s: &Sighting| {
        let camera_tag = match node {
            Node::Photo(_) => pose * poses.tags[s.tag]?,
            Node::Tag(_) => poses.photos[s.photo]? * pose,
        };
        Some(
            net.squared_px_under(&camera_tag, s)
                .iter()
                .map(|e| loss.cost(*e))
                .sum::<f64>(),
        )
    };
    net.sightings_of(node).filter_map(cost).sum()
}
