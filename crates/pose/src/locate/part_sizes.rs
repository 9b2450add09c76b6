//! Some of the tags printed larger or smaller than their scene says: all cards and not the mat, or those of one printer.

use std::collections::BTreeSet;

use super::LocatedPhoto;
use super::factor::{self, Factor, FactorKind, TagSet};
use super::matches::Ignored;
use crate::scene::{Scene, Tag, TagFamily};

#[derive(Debug, Clone, PartialEq)]
pub struct PartSize {
    pub size: Factor,
    /// Which tags, in ascending order.
    pub tags: Vec<(TagFamily, u32)>,
}

/// Of the photos with a tag, this share leaves it out where it is taken for wrong.
const OFTEN: f64 = 0.6;

/// A tag that faces up or down to this cosine lies flat.
const FLAT: f64 = 0.95;

/// The parts that are likely to be wrong together, each with the factor of its sizes that fits the photos best.
pub(super) fn fits(photos: &[&LocatedPhoto], scene: &Scene) -> Vec<PartSize> {
    let fit = |part: TagSet| {
        let size = factor::fit(FactorKind::PartSize(&part), photos, scene)?;
        let tags = part.into_iter().collect();
        Some(PartSize { size, tags })
    };
    parts(photos, scene).into_iter().filter_map(fit).collect()
}

/// Whether the pose of a photo leaves a tag out that is not where the others expect it.
pub(super) fn has_outlier(photo: &LocatedPhoto) -> bool {
    !outliers(photo).is_empty()
}

/// Ids of the tags that are not where the others expect them.
fn outliers(photo: &LocatedPhoto) -> BTreeSet<u32> {
    let ignored = photo.result.iter().flat_map(|located| &located.ignored_tags);
    let is_off = |why: Ignored| matches!(why, Ignored::Moved | Ignored::CornerOff);
    ignored.filter(|tag| is_off(tag.why)).map(|tag| tag.id).collect()
}

/// Proper parts of the scene's tags of at least two: those left out again and again, those that lie flat and those that do not, those of one size.
fn parts(photos: &[&LocatedPhoto], scene: &Scene) -> BTreeSet<TagSet> {
    let part = |is_in: &dyn Fn(&&Tag) -> bool| -> TagSet {
        scene
            .tags
            .iter()
            .filter(is_in)
            .map(|tag| (tag.family, tag.id))
            .collect()
    };
    let is_flat = |tag: &&Tag| tag.right.cross(&tag.up).z.abs() > FLAT;
    let is_left_out = |tag: &&Tag| {
        let shows =
            |p: &&&LocatedPhoto| p.result.is_ok() && p.seen.iter().any(|s| (s.family, s.id) == (tag.family, tag.id));
        let with = photos.iter().filter(shows).count();
        let without = photos
            .iter()
            .filter(shows)
            .filter(|photo| outliers(photo).contains(&tag.id))
            .count();
        without >= 2 && without as f64 >= OFTEN * with as f64
    };
    let of_size = |tag: &Tag| part(&|other| other.size_mm == tag.size_mm);
    let all = [part(&is_left_out), part(&is_flat), part(&|tag| !is_flat(tag))];
    let all = all.into_iter().chain(scene.tags.iter().map(of_size));
    all.filter(|part| part.len() >= 2 && part.len() < scene.tags.len())
        .collect()
}
