//! Tags that the photos disagree about: moved between photos, of another size than stated, not where they were said to be.

use super::adjust::{Free, Loss, adjust, cost, unknowns};
use super::grow::{candidates, rough};
use super::network::{Node, Poses, Sighting, TagNetwork};
use super::residual::rms_px;

/// A sighting is off when its corners are so many σ off (root mean square over the corners; √2 σ is usual).
const OFF_SIGMAS: f64 = 6.0;

/// Less than this is never off: print, paper and detector are no better. An angle, so that it holds at every resolution.
const LEAST_OFF_DEG: f64 = 0.04;

/// A single sighting that is off by less than this at the tag's distance is a badly seen corner, not a moved tag. mm.
const LEAST_MOVE_MM: f64 = 1.0;

/// A size further than this from the stated one is wrong; paper and printers are better.
const SIZE_TOLERANCE: f64 = 0.01;

/// What is wrong with a tag.
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

/// σ of a corner coordinate in px, by the median residual, which a few bad tags do not change.
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

/// A root mean square above this is off.
pub(super) fn limit_px(net: &TagNetwork, noise_px: f64) -> f64 {
    (OFF_SIGMAS * noise_px).max(LEAST_OFF_DEG / net.camera.deg_per_px())
}

/// Root mean square distance of a sighting's corners from where the poses put them, px.
pub(super) fn rms(s: &Sighting, net: &TagNetwork, poses: &Poses) -> Option<f64> {
    net.squared_px(s, poses).map(rms_px)
}

/// The tag that is furthest off, and what is wrong with it; `None` when every tag fits.
///
/// The others are adjusted without it first, so that it does not judge itself.
pub(super) fn worst(net: &TagNetwork, poses: &Poses, limit_px: f64) -> Option<(usize, TagFault)> {
    let off = net.sightings.iter().filter_map(|s| Some((rms(s, net, poses)?, s.tag)));
    let mut tags: Vec<(f64, usize)> = off.filter(|(rms, _)| *rms > limit_px).collect();
    tags.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut asked = Vec::new();
    for (_, tag) in tags {
        if !asked.contains(&tag) {
            asked.push(tag);
            if let Some(fault) = fault(net, poses, tag, limit_px) {
                return Some((tag, fault));
            }
        }
    }
    None
}

fn fault(net: &TagNetwork, poses: &Poses, tag: usize, limit_px: f64) -> Option<TagFault> {
    let (own, poses) = alone(net, poses, tag);
    let everywhere: Vec<usize> = net.sightings_of(Node::Tag(tag)).map(|s| s.photo).collect();
    let group = largest_group(&own, &poses, tag, limit_px);
    if let Some((place, here)) = &group
        && here.len() == everywhere.len()
    {
        let given = net.tags[tag].fixed?;
        let mm = (given.translation.vector - place.tags[tag]?.translation.vector).norm();
        return Some(TagFault::NotWhereGiven { mm });
    }
    if let Some(fits_mm) = other_size(&own, &poses, tag, limit_px) {
        return Some(TagFault::WrongSize { fits_mm });
    }
    let Some((place, here)) = group else {
        return Some(TagFault::BadlySeen { photos: everywhere });
    };
    let rest = own.with(|s| !here.contains(&s.photo));
    let off_mm = rest.sightings.iter().filter_map(|s| {
        let depth_mm = place.camera_tag(s)?.translation.z;
        Some(rms(s, &rest, &place)? * depth_mm * net.camera.deg_per_px().to_radians())
    });
    let off_mm = off_mm.fold(0.0, f64::max);
    let there = largest_group(&rest, &poses, tag, limit_px).filter(|_| off_mm > LEAST_MOVE_MM);
    Some(match there {
        Some((other, there)) => TagFault::Moved {
            mm: (place.tags[tag]?.translation.vector - other.tags[tag]?.translation.vector).norm(),
            here,
            there,
        },
        None => TagFault::BadlySeen {
            photos: everywhere.into_iter().filter(|p| !here.contains(p)).collect(),
        },
    })
}

/// The sightings of one tag, and the photos' poses as the other tags have them.
fn alone<'a>(net: &TagNetwork<'a>, poses: &Poses, tag: usize) -> (TagNetwork<'a>, Poses) {
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

/// The pose of a tag that fits in most of its photos, and those photos.
fn largest_group(own: &TagNetwork, poses: &Poses, tag: usize, limit_px: f64) -> Option<(Poses, Vec<usize>)> {
    let fits = |poses: &Poses| -> Vec<usize> {
        let is_fitting = |s: &&Sighting| rms(s, own, poses).is_some_and(|r| r <= limit_px);
        own.sightings.iter().filter(is_fitting).map(|s| s.photo).collect()
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

/// The size with which the tag fits in all its photos, when it is seen in two at least and the size is not the stated one.
fn other_size(own: &TagNetwork, poses: &Poses, tag: usize, limit_px: f64) -> Option<f64> {
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
    let is_fitting = |s: &Sighting| rms(s, &sized, &placed).is_some_and(|r| r <= limit_px);
    let fits = sized.sightings.iter().all(is_fitting);
    (fits && own.sightings.len() > 1 && (ratio - 1.0).abs() > SIZE_TOLERANCE).then_some(stated_mm * ratio)
}
