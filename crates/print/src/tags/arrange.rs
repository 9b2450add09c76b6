//! Arrangement of a scene's tags: the kind of print for each, by its pose.

use super::tent::Tent;
use scaleproof_pose::scene::{Scene, Tag};

/// Maximum height of an upward-facing tag on the mat.
pub const FLAT_MM: f64 = 2.0;
/// Maximum angle between the normal of a tag on the mat and straight up.
const FLAT_DEG: f64 = 0.5;
/// Height above which a flat tag is noticeably displaced by the mat.
const LIFT_MM: f64 = 0.2;

/// Tags of a scene by their kind of print; each tag is in one list.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Arrangement<'a> {
    /// Tags on the ground mat: they face straight up and lie on the ground (within [`FLAT_MM`]).
    pub flat: Vec<&'a Tag>,
    /// Pairs that lean back to back, as required by [`Tent::new`].
    pub tents: Vec<Tent>,
    /// All others: on plain cards, to be fixed at their places in the scene.
    pub cards: Vec<&'a Tag>,
}

/// Sorts the tags of a scene. Of all pairs that could share a card the closest is formed first, regardless of the scene's order.
pub fn arrange(scene: &Scene) -> Arrangement<'_> {
    let (flat, mut rest): (Vec<&Tag>, Vec<&Tag>) = scene.tags.iter().partition(|tag| lies_flat(tag));
    let mut pairs: Vec<(f64, usize, usize, Tent)> = Vec::new();
    for (i, a) in rest.iter().enumerate() {
        for (j, b) in rest.iter().enumerate().skip(i + 1) {
            let apart_mm = (a.centre_mm - b.centre_mm).norm();
            pairs.extend(Tent::new(a, b).map(|tent| (apart_mm, i, j, tent)));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = vec![false; rest.len()];
    let mut tents: Vec<Option<Tent>> = vec![None; rest.len()];
    for (_, i, j, tent) in pairs {
        if !taken[i] && !taken[j] {
            (taken[i], taken[j]) = (true, true);
            tents[i] = Some(tent);
        }
    }
    let mut taken = taken.into_iter();
    rest.retain(|_| !taken.next().unwrap_or(false));
    Arrangement {
        flat,
        tents: tents.into_iter().flatten().collect(),
        cards: rest,
    }
}

fn lies_flat(tag: &Tag) -> bool {
    let up = tag.right.cross(&tag.up).z;
    up > FLAT_DEG.to_radians().cos() && tag.centre_mm.z.abs() <= FLAT_MM
}

impl<'a> Arrangement<'a> {
    pub fn plain(scene: &'a Scene) -> Self {
        Self {
            cards: scene.tags.iter().collect(),
            ..Self::default()
        }
    }

    /// Returns the height of the flat tag farthest from the mat, if it exceeds `LIFT_MM`.
    pub fn lifted_mm(&self) -> Option<f64> {
        let heights = self.flat.iter().map(|tag| tag.centre_mm.z);
        heights
            .filter(|z| z.abs() > LIFT_MM)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }
}
