//! Wrong print size of some tags: all cards and not the mat, or those of one printer.

use std::collections::BTreeSet;

use super::LocatedPhoto;
use super::factor::{self, Factor, FactorKind, TagSet};
use super::matches::Ignored;
use crate::scene::{Scene, Tag, TagFamily};

#[derive(Debug, Clone, PartialEq)]
pub struct PartSize {
    pub size: Factor,
    /// Tags of the part, in ascending order.
    pub tags: Vec<(TagFamily, u32)>,
}

/// Share of the photos with a tag that must reject it as an outlier for the tag to be suspect.
const OFTEN: f64 = 0.6;

/// Absolute cosine between a tag's normal and the vertical above which the tag lies flat.
const FLAT: f64 = 0.95;

/// Fits a size factor to each plausible part of the tags.
pub(super) fn fits(photos: &[&LocatedPhoto], scene: &Scene) -> Vec<PartSize> {
    let fit = |part: TagSet| {
        let size = factor::fit(FactorKind::PartSize(&part), photos, scene)?;
        let tags = part.into_iter().collect();
        Some(PartSize { size, tags })
    };
    parts(photos, scene).into_iter().filter_map(fit).collect()
}

/// Returns true if the photo's pose rejected a tag as displaced.
pub(super) fn has_outlier(photo: &LocatedPhoto) -> bool {
    !outliers(photo).is_empty()
}

/// Returns the ids of the tags that the photo's pose rejected as displaced.
fn outliers(photo: &LocatedPhoto) -> BTreeSet<u32> {
    let ignored = photo.result.iter().flat_map(|located| &located.ignored_tags);
    let is_off = |why: Ignored| matches!(why, Ignored::Moved | Ignored::CornerOff);
    ignored.filter(|tag| is_off(tag.why)).map(|tag| tag.id).collect()
}

/// Returns the plausible proper parts of the scene's tags, of at least two each: those often rejected, those that lie flat and those that do not,
/// those of one size.
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
