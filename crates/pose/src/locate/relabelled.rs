//! Faults common to all cards of a scene: all turned alike on their paper, or all ids shifted by one number.

use std::collections::BTreeSet;

use super::factor::{agree, spread};
use super::{LocatedPhoto, matches};
use crate::scene::{Scene, TagFamily};
use crate::tags::SeenTag;

/// Fault common to all cards, and the evidence for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relabelled {
    pub cards: CardFault,
    /// Number of photos that were tried and show two tags or more.
    pub telling: usize,
    /// Number of those that are located reliably once the fault is corrected.
    pub healed: usize,
}

/// Fault common to all cards, in the units of `[cards]` in `scene.toml`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CardFault {
    /// All cards are turned clockwise as one looks at them, degrees: 90, 180 or 270.
    Turned { deg: u32 },
    /// All cards' ids are higher than the scene's by this number, or lower if it is negative.
    Ids { higher_by: i64 },
}

/// Number of photos, spread evenly, that are tried.
const TRIED: usize = 12;
/// Minimum number of healed photos, and their minimum share of the telling ones.
const FEWEST: usize = 3;
const MOST: f64 = 0.8;
/// Maximum number of possible id shifts; with more the evidence is too weak.
const MOST_SHIFTS: usize = 64;

/// Finds the only fault whose correction makes nearly all photos good; `None` if there is none or more than one.
pub(super) fn find(photos: &[&LocatedPhoto], scene: &Scene) -> Option<Relabelled> {
    let photos = spread(photos, TRIED);
    let turned = [90, 180, 270].map(|deg| CardFault::Turned { deg });
    let faults = turned.into_iter().chain(shifts(&photos, scene));
    let mut healing = faults.filter_map(|cards| healing(cards, &photos, scene));
    let found = healing.next()?;
    healing.next().is_none().then_some(found)
}

/// Returns the id shifts that map every seen tag to one of the scene.
fn shifts(photos: &[&LocatedPhoto], scene: &Scene) -> Vec<CardFault> {
    let seen: BTreeSet<_> = photos.iter().flat_map(|p| &p.seen).map(|t| (t.family, t.id)).collect();
    let Some((family, lowest)) = seen.first().copied() else {
        return Vec::new();
    };
    let of_family = scene.tags.iter().filter(|tag| tag.family == family);
    let by: BTreeSet<i64> = of_family.map(|tag| i64::from(lowest) - i64::from(tag.id)).collect();
    let is_scenes =
        |by: i64, (family, id): &(TagFamily, u32)| lower(*id, by).and_then(|id| scene.tag(*family, id)).is_some();
    let fits = |by: &i64| seen.iter().all(|tag| is_scenes(*by, tag));
    let shifts = by.into_iter().filter(|by| *by != 0).filter(fits);
    let faults: Vec<CardFault> = shifts.map(|higher_by| CardFault::Ids { higher_by }).collect();
    if faults.len() > MOST_SHIFTS { Vec::new() } else { faults }
}

fn lower(id: u32, by: i64) -> Option<u32> {
    u32::try_from(i64::from(id) - by).ok()
}

/// Returns the evidence for a fault, if there is enough.
fn healing(cards: CardFault, photos: &[&LocatedPhoto], scene: &Scene) -> Option<Relabelled> {
    let righted = photos.iter().filter_map(|photo| {
        let seen: Vec<SeenTag> = photo.seen.iter().map(|tag| cards.righted(tag)).collect();
        let is_telling = matches::match_tags(&seen, scene).is_ok_and(|(matches, _)| matches.len() >= 2);
        is_telling.then_some((seen, &photo.fitted.as_ref().ok()?.camera))
    });
    let righted: Vec<_> = righted.collect();
    let healed = righted
        .iter()
        .filter(|(seen, camera)| agree(seen, scene, camera))
        .count();
    let telling = righted.len();
    let is_enough = healed >= FEWEST && healed as f64 >= MOST * telling as f64 && 2 * telling >= photos.len();
    is_enough.then_some(Relabelled { cards, telling, healed })
}

impl CardFault {
    /// Returns the tag with this fault corrected.
    fn righted(self, tag: &SeenTag) -> SeenTag {
        let mut righted = tag.clone();
        match self {
            // The tag's own top-left corner lies where the scene has the top-right one.
            CardFault::Turned { deg } => righted.corners_px.rotate_right(deg as usize / 90),
            CardFault::Ids { higher_by } => righted.id = lower(tag.id, higher_by).unwrap_or(tag.id),
        }
        righted
    }

    /// Returns a clause that describes the fault.
    pub(super) fn clause(self) -> String {
        match self {
            CardFault::Turned { deg: 180 } => {
                "all tags are turned by 180° (as OpenCV’s generator draws them)".to_owned()
            }
            CardFault::Turned { deg } => format!("all tags are turned by {deg}° clockwise"),
            CardFault::Ids { higher_by } if higher_by < 0 => format!("the ids of all tags are {} lower", -higher_by),
            CardFault::Ids { higher_by } => format!("the ids of all tags are {higher_by} higher"),
        }
    }

    /// Returns the line of `[cards]` in `scene.toml` that declares the fault.
    pub(super) fn line(self) -> String {
        match self {
            CardFault::Turned { deg } => format!("turned_deg = {deg}"),
            CardFault::Ids { higher_by } => format!("ids_higher_by = {higher_by}"),
        }
    }
}
