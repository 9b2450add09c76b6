//! What makes all cards of a set other than their scene says: all turned alike on their paper, or all with ids that are higher by one number.

use std::collections::BTreeSet;

use super::factor::{agree, spread};
use super::{LocatedPhoto, matches};
use crate::scene::{Scene, TagFamily};
use crate::tags::SeenTag;

/// How all cards differ from their scene, and what speaks for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relabelled {
    pub cards: CardFault,
    /// Photos that were tried and show two tags or more.
    pub telling: usize,
    /// Those of them that are located without doubt when the fault is taken away.
    pub healed: usize,
}

/// One fault of all cards, in the units of `[cards]` in `scene.toml`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CardFault {
    /// Clockwise as one looks at them, degrees: 90, 180 or 270.
    Turned { deg: u32 },
    /// The cards' ids are higher by this than the scene's, or lower where it is negative.
    Ids { higher_by: i64 },
}

/// So many photos, spread evenly, are tried.
const TRIED: usize = 12;
/// So many photos must be healed, and this share of those that tell.
const FEWEST: usize = 3;
const MOST: f64 = 0.8;
/// Ids shifted in more ways than this could be anything.
const MOST_SHIFTS: usize = 64;

/// The one fault without which nearly all photos are good; nothing where there is none, or several do as well.
pub(super) fn find(photos: &[&LocatedPhoto], scene: &Scene) -> Option<Relabelled> {
    let photos = spread(photos, TRIED);
    let turned = [90, 180, 270].map(|deg| CardFault::Turned { deg });
    let faults = turned.into_iter().chain(shifts(&photos, scene));
    let mut healing = faults.filter_map(|cards| healing(cards, &photos, scene));
    let found = healing.next()?;
    healing.next().is_none().then_some(found)
}

/// The shifts that make every tag that was seen one of the scene.
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

/// What speaks for a fault, if enough does.
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
    /// The tag as a scene without this fault has it.
    fn righted(self, tag: &SeenTag) -> SeenTag {
        let mut righted = tag.clone();
        match self {
            // The tag's own top-left corner lies where the scene has the top-right one.
            CardFault::Turned { deg } => righted.corners_px.rotate_right(deg as usize / 90),
            CardFault::Ids { higher_by } => righted.id = lower(tag.id, higher_by).unwrap_or(tag.id),
        }
        righted
    }

    /// What the cards are, as a clause.
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

    /// The line of `[cards]` that says so.
    pub(super) fn line(self) -> String {
        match self {
            CardFault::Turned { deg } => format!("turned_deg = {deg}"),
            CardFault::Ids { higher_by } => format!("ids_higher_by = {higher_by}"),
        }
    }
}
