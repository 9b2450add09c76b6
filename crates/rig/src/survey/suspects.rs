//! Tags that the photos disagree about: moved between photos, of another size than stated, not where they were said to be.
//!
//! A chain of tags drifts, and without one of its tags it drifts apart, so that the tag seems to stand in two places. A fault is therefore only
//! believed when the joint adjustment of everything leaves much less with it than without.

use super::adjust::{Free, Loss, adjust, cost, cost_after_step, unknowns};
use super::grow::{candidates, close, rough};
use super::network::{Node, Poses, Sighting, SizedTag, TINY, TagNetwork};
use scaleproof_pose::locate::{area_px, expected_px2};

/// Number of σ (root mean square over the corners; √2 σ is usual) above which a sighting is off.
const OFF_SIGMAS: f64 = 6.0;

/// Number of σ of a corner coordinate by whose square a fault must lower the cost of the joint adjustment to be believed. Where none moved, one tag
/// in two places gains 4.8 σ at most in 50 simulated rooms; in a room of real paper 9 σ of the median noise and 6 of the expected one.
const FAULT_SIGMAS: f64 = 8.0;

/// Factor for noise below the expected one, which has tails.
const TAILS: f64 = 1.5;

/// Largest number of photos of a tag that are parted in every way.
const MOST_PARTED: usize = 6;

/// Angle below which a sighting is never off: print, paper and detector are no better. An angle holds at every resolution.
const LEAST_OFF_DEG: f64 = 0.04;

/// Distance at the tag, mm, below which a single sighting that is off is a badly seen corner, not a moved tag.
const LEAST_MOVE_MM: f64 = 1.0;

/// Relative difference from the stated size above which a size is wrong; paper and printers are better.
const SIZE_TOLERANCE: f64 = 0.01;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum TagFault {
    /// It stands elsewhere in the other photos.
    Moved {
        mm: f64,
        here: Vec<usize>,
        there: Vec<usize>,
    },
    WrongSize {
        fits_mm: f64,
    },
    /// A fixed tag: all photos agree on another place.
    NotWhereGiven {
        mm: f64,
    },
    /// Its corners are off in these photos only, and no place explains them.
    BadlySeen {
        photos: Vec<usize>,
    },
}

/// Returns σ of a corner coordinate of a tiny tag (weight 1) in px, by the median residual, which a few bad tags do not change.
pub(super) fn noise_px(net: &TagNetwork, poses: &Poses) -> f64 {
    let squared = net.sightings.iter().filter_map(|s| net.squared_px(s, poses));
    let mut squared: Vec<f64> = squared.flatten().collect();
    if squared.is_empty() {
        return 0.0;
    }
    squared.sort_by(f64::total_cmp);
    let numbers = 2.0 * squared.len() as f64;
    // The squared length of two normal numbers has its median at 2 ln 2; what the unknowns take up is missing.
    let spare = (numbers - unknowns(net, poses) as f64).max(1.0);
    (squared[squared.len() / 2] / (2.0 * std::f64::consts::LN_2) * numbers / spare).sqrt()
}

/// Limit above which a sighting is off.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    noise_px: f64,
    least_px: f64,
}

impl Limit {
    /// Makes the limit by the noise that these poses leave.
    pub(super) fn new(net: &TagNetwork, poses: &Poses) -> Limit {
        Limit {
            noise_px: noise_px(net, poses),
            least_px: LEAST_OFF_DEG / net.camera.deg_per_px(),
        }
    }

    /// Returns the root mean square in px above which a sighting is off.
    pub(super) fn px(self, s: &Sighting) -> f64 {
        (OFF_SIGMAS * self.noise_px / s.weight.sqrt()).max(self.least_px)
    }

    fn fits(self, s: &Sighting, net: &TagNetwork, poses: &Poses) -> bool {
        rms(s, net, poses).is_some_and(|rms| rms <= self.px(s))
    }

    /// Returns the amount by which a fault of the tag with these sightings must lower the cost, weighted px².
    fn gain<'s>(self, own: impl Iterator<Item = &'s Sighting>) -> f64 {
        let noise_px = (TAILS * self.noise_px).min(self.noise_px.max(expected_px2(&TINY).sqrt()));
        let least = own.map(|s| 4.0 * s.weight * self.least_px.powi(2));
        least.fold((FAULT_SIGMAS * noise_px).powi(2), f64::max)
    }
}

/// Returns the root mean square distance of a sighting's corners from where the poses put them, px.
pub(super) fn rms(s: &Sighting, net: &TagNetwork, poses: &Poses) -> Option<f64> {
    let squared = net.squared_px(s, poses)?;
    Some((squared.iter().sum::<f64>() / 4.0 / s.weight).sqrt())
}

/// Returns the tag whose fault explains most of what is off, and the fault; `None` when every sighting fits, or no fault of one tag explains it.
pub(super) fn worst(net: &TagNetwork, poses: &Poses, limit: Limit) -> Option<(usize, TagFault)> {
    let off = net
        .sightings
        .iter()
        .filter(|s| rms(s, net, poses).is_none_or(|rms| rms > limit.px(s) / 2.0));
    let photos: Vec<usize> = off.map(|s| s.photo).collect();
    // The loss may have attributed the fault to another tag of the photo.
    let suspects = (0..net.tags.len()).filter(|t| net.sightings_of(Node::Tag(*t)).any(|s| photos.contains(&s.photo)));
    let left = cost(net, poses, rough(net));
    let hypotheses = suspects.flat_map(|tag| {
        let both = fault(net, poses, tag, limit).into_iter().chain(parted(net, poses, tag));
        both.map(move |hypothesis| (tag, hypothesis))
    });
    let explained = hypotheses.filter_map(|(tag, mut with)| {
        adjust(&with.net, &mut with.poses, Free::All, rough(net), 30);
        close(&with.net, &mut with.poses);
        let gain = left - cost(&with.net, &with.poses, rough(net));
        if let TagFault::BadlySeen { photos } = &with.fault {
            // Off by more than the tag is large: another arrangement of the tags, no bad corner.
            let is_far = |s: &Sighting| rms(s, net, &with.poses).is_none_or(|rms| rms * rms > area_px(&s.corners_px));
            if net
                .sightings_of(Node::Tag(tag))
                .any(|s| photos.contains(&s.photo) && is_far(s))
            {
                return None;
            }
        }
        (gain > limit.gain(net.sightings_of(Node::Tag(tag)))).then_some((gain, tag, with.fault))
    });
    let (_, tag, fault) = explained.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((tag, fault))
}

/// A fault that a tag may have, and the network and the poses if it has.
struct Hypothesis {
    fault: TagFault,
    net: TagNetwork,
    poses: Poses,
}

fn fault(net: &TagNetwork, poses: &Poses, tag: usize, limit: Limit) -> Option<Hypothesis> {
    let (own, poses) = alone(net, poses, tag);
    let everywhere: Vec<usize> = own.sightings.iter().map(|s| s.photo).collect();
    let group = largest_group(&own, &poses, tag, limit);
    // A tag that is freed leaves the frame to the other fixed ones.
    let mut freed = net.clone();
    freed.tags[tag].fixed = None;
    let is_tied = freed.sightings.iter().any(|s| freed.is_fixed(s.tag));
    if let Some((place, here)) = &group
        && here.len() == everywhere.len()
    {
        let given = net.tags[tag].fixed.filter(|_| is_tied)?;
        let mm = (given.translation.vector - place.tags[tag]?.translation.vector).norm();
        return Some(Hypothesis {
            fault: TagFault::NotWhereGiven { mm },
            net: freed,
            poses: place.clone(),
        });
    }
    if let Some((fits_mm, sized)) = other_size(&own, &poses, tag, limit) {
        let mut net = net.clone();
        net.tags[tag].size_mm = fits_mm;
        return Some(Hypothesis {
            fault: TagFault::WrongSize { fits_mm },
            net,
            poses: sized,
        });
    }
    let badly_seen = |photos: Vec<usize>, poses| Hypothesis {
        net: net.with(|s| s.tag != tag || !photos.contains(&s.photo)),
        fault: TagFault::BadlySeen { photos },
        poses,
    };
    let Some((place, here)) = group else {
        return Some(badly_seen(everywhere, poses));
    };
    let rest = own.with(|s| !here.contains(&s.photo));
    let off_mm = rest.sightings.iter().filter_map(|s| {
        let depth_mm = place.camera_tag(s)?.translation.z;
        Some(rms(s, &rest, &place)? * depth_mm * net.camera.deg_per_px().to_radians())
    });
    let off_mm = off_mm.fold(0.0, f64::max);
    let there = largest_group(&rest, &poses, tag, limit).filter(|_| off_mm > LEAST_MOVE_MM);
    let Some((other, there)) = there else {
        let elsewhere = everywhere.into_iter().filter(|p| !here.contains(p)).collect();
        return Some(badly_seen(elsewhere, place));
    };
    let mm = (place.tags[tag]?.translation.vector - other.tags[tag]?.translation.vector).norm();
    let mut poses = place;
    let net = twinned(if is_tied { &freed } else { net }, tag, &there);
    poses.tags.push(other.tags[tag]);
    poses.tags[tag] = net.tags[tag].fixed.or(poses.tags[tag]);
    Some(Hypothesis {
        fault: TagFault::Moved { mm, here, there },
        net,
        poses,
    })
}

/// Returns the network with one more tag, which stands in the place of `tag` in these photos.
fn twinned(net: &TagNetwork, tag: usize, there: &[usize]) -> TagNetwork {
    let mut net = net.clone();
    let twin = net.tags.len();
    net.tags.push(SizedTag {
        fixed: None,
        ..net.tags[tag].clone()
    });
    for s in net
        .sightings
        .iter_mut()
        .filter(|s| s.tag == tag && there.contains(&s.photo))
    {
        s.tag = twin;
    }
    net
}

/// Returns the fault of a tag in two places, its photos parted so that the joint adjustment has the least cost.
fn parted(net: &TagNetwork, poses: &Poses, tag: usize) -> Option<Hypothesis> {
    let photos: Vec<usize> = net.sightings_of(Node::Tag(tag)).map(|s| s.photo).collect();
    let mut poses = poses.clone();
    poses.tags.push(poses.tags[tag]);
    let left = |there: Vec<usize>| {
        let net = twinned(net, tag, &there);
        (cost_after_step(&net, &poses, rough(&net)), there, net)
    };
    let (_, there, with_twin) = partings(&photos)
        .into_iter()
        .map(left)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    adjust(&with_twin, &mut poses, Free::All, rough(net), 30);
    let [place, other] = [tag, net.tags.len()].map(|t| poses.tags[t]);
    let mm = (place?.translation.vector - other?.translation.vector).norm();
    let here = photos.into_iter().filter(|p| !there.contains(p)).collect();
    let (fault, net) = if mm > LEAST_MOVE_MM {
        (TagFault::Moved { mm, here, there }, with_twin)
    } else {
        let net = net.with(|s| s.tag != tag || !there.contains(&s.photo));
        (TagFault::BadlySeen { photos: there }, net)
    };
    Some(Hypothesis { fault, net, poses })
}

/// Returns the ways to part the photos of a tag in two, each by its smaller part: every one when they are few; else one photo from the others, and
/// earlier from later ones.
fn partings(photos: &[usize]) -> Vec<Vec<usize>> {
    let n = photos.len();
    let pick = |is_there: &dyn Fn(usize) -> bool| {
        let part = |there: bool| {
            (0..n)
                .filter(|i| is_there(*i) == there)
                .map(|i| photos[i])
                .collect::<Vec<_>>()
        };
        let (one, other) = (part(true), part(false));
        if one.len() <= other.len() { one } else { other }
    };
    if n <= MOST_PARTED {
        return (1..1_usize << n.saturating_sub(1))
            .map(|bits| pick(&|i| bits >> i & 1 == 1))
            .collect();
    }
    let alone = (0..n).map(|one| pick(&|i| i == one));
    alone.chain((2..n - 1).map(|first| pick(&|i| i >= first))).collect()
}

/// Returns the sightings of one tag, and the photos' poses as the other tags have them.
fn alone(net: &TagNetwork, poses: &Poses, tag: usize) -> (TagNetwork, Poses) {
    let mut others = net.with(|s| s.tag != tag);
    let mut poses = poses.clone();
    if others.sightings.iter().all(|s| !others.is_fixed(s.tag)) {
        // The one fixed tag is in question: another one holds the frame meanwhile.
        let most =
            (0..others.tags.len()).max_by_key(|t| (others.sightings_of(Node::Tag(*t)).count(), std::cmp::Reverse(*t)));
        if let Some(most) = most {
            others.tags[most].fixed = poses.tags[most];
        }
    }
    adjust(&others, &mut poses, Free::All, rough(net), 50);
    let mut own = net.with(|s| s.tag == tag && others.is_seen(Node::Photo(s.photo)));
    own.tags[tag].fixed = None;
    (own, poses)
}

/// Returns the pose of a tag that fits in most of its photos, and those photos.
fn largest_group(own: &TagNetwork, poses: &Poses, tag: usize, limit: Limit) -> Option<(Poses, Vec<usize>)> {
    let fits = |poses: &Poses| -> Vec<usize> {
        own.sightings
            .iter()
            .filter(|s| limit.fits(s, own, poses))
            .map(|s| s.photo)
            .collect()
    };
    let groups = candidates(own, poses, Node::Tag(tag)).into_iter().map(|start| {
        let mut placed = poses.clone();
        placed.tags[tag] = Some(start);
        adjust(own, &mut placed, Free::Only(Node::Tag(tag)), rough(own), 30);
        let group = fits(&placed);
        let together = own.with(|s| group.contains(&s.photo));
        adjust(&together, &mut placed, Free::Only(Node::Tag(tag)), Loss::Squared, 30);
        let group = fits(&placed);
        (placed, group)
    });
    // The first of the largest.
    let fitting = groups.filter(|(_, group)| !group.is_empty());
    fitting.min_by_key(|(_, group)| std::cmp::Reverse(group.len()))
}

/// Returns the size with which the tag fits in all its photos, and its pose then, when it is seen in two at least and the size is not the stated one.
fn other_size(own: &TagNetwork, poses: &Poses, tag: usize, limit: Limit) -> Option<(f64, Poses)> {
    let stated_mm = own.tags[tag].size_mm;
    let fitted = |ln_ratio: f64| {
        let ratio = ln_ratio.exp();
        let mut sized = own.clone();
        sized.tags[tag].size_mm = stated_mm * ratio;
        // A larger tag with the same corners is further by as much, turned as it was.
        for branch in sized.sightings.iter_mut().flat_map(|s| &mut s.branches) {
            branch.translation.vector *= ratio;
        }
        let placed = |start| {
            let mut placed = poses.clone();
            placed.tags[tag] = Some(start);
            (cost(&sized, &placed, rough(own)), placed)
        };
        let starts = candidates(&sized, poses, Node::Tag(tag)).into_iter().map(placed);
        let nearest = starts.min_by(|a, b| a.0.total_cmp(&b.0));
        let mut placed = nearest.map_or_else(|| poses.clone(), |(_, placed)| placed);
        let left = adjust(&sized, &mut placed, Free::Only(Node::Tag(tag)), Loss::Squared, 30);
        (left, sized, placed)
    };
    // From a third to three times the stated size; then the best of the steps is refined by golden section.
    const STEP: f64 = 0.1;
    let left = |x: &f64| fitted(*x).0;
    let steps: Vec<(f64, f64)> = (-11..=11).map(|i| f64::from(i) * STEP).map(|x| (left(&x), x)).collect();
    let best = steps.iter().min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    let (mut low, mut high) = (best - STEP, best + STEP);
    const GOLDEN: f64 = 0.618_033_988_749_895;
    for _ in 0..20 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if left(&a) < left(&b) { high = b } else { low = a }
    }
    let ratio = ((low + high) / 2.0).exp();
    let (_, sized, placed) = fitted(ratio.ln());
    let fits = sized.sightings.iter().all(|s| limit.fits(s, &sized, &placed));
    (fits && own.sightings.len() > 1 && (ratio - 1.0).abs() > SIZE_TOLERANCE).then_some((stated_mm * ratio, placed))
}
