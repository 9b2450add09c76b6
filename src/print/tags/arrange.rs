//! What each tag of a scene is printed on, by where it stands.

use std::collections::VecDeque;

use super::tent::Tent;
use crate::scene::{Scene, Tag};

/// A tag that looks up and is no higher than this lies on the mat.
pub const FLAT_MM: f64 = 2.0;
/// How far from straight up a tag on the mat may look.
const FLAT_DEG: f64 = 0.5;
/// A flat tag higher than this is not quite where the mat puts it.
const LIFT_MM: f64 = 0.2;

/// The tags of a scene, by what they are printed on; each tag is in one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrangement<'a> {
    /// On the ground mat: they look straight up and lie on the ground (within [`FLAT_MM`]).
    pub flat: Vec<&'a Tag>,
    /// Pairs that lean back to back, as [`Tent::of`] says.
    pub tents: Vec<Tent>,
    /// Everything else: a plain card, to be fixed where the scene says.
    pub cards: Vec<&'a Tag>,
}

/// Sorts the tags of a scene. A tag's partner on a card is the first of the scene that fits.
pub fn arrange(scene: &Scene) -> Arrangement<'_> {
    let (flat, rest): (Vec<&Tag>, Vec<&Tag>) = scene.tags.iter().partition(|tag| lies_flat(tag));
    let (mut tents, mut cards) = (Vec::new(), Vec::new());
    let mut waiting = VecDeque::from(rest);
    while let Some(tag) = waiting.pop_front() {
        let tent = |(i, other): (usize, &&Tag)| Tent::of(tag, other).map(|tent| (i, tent));
        match waiting.iter().enumerate().find_map(tent) {
            Some((i, tent)) => {
                waiting.remove(i);
                tents.push(tent);
            }
            None => cards.push(tag),
        }
    }
    Arrangement { flat, tents, cards }
}

fn lies_flat(tag: &Tag) -> bool {
    let up = tag.right.cross(&tag.up).z;
    up > FLAT_DEG.to_radians().cos() && tag.centre_mm.z.abs() <= FLAT_MM
}

impl<'a> Arrangement<'a> {
    /// Every tag on a plain card.
    pub fn plain(scene: &'a Scene) -> Self {
        Self {
            flat: Vec::new(),
            tents: Vec::new(),
            cards: scene.tags.iter().collect(),
        }
    }

    /// How far above the mat the scene puts the flat tag that is farthest from it, if that is worth a word.
    pub fn lifted_mm(&self) -> Option<f64> {
        let heights = self.flat.iter().map(|tag| tag.centre_mm.z);
        heights
            .filter(|z| z.abs() > LIFT_MM)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}
