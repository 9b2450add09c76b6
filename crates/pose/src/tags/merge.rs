//! Merging of the tags from several searches of one photo; each tag is fitted once.

use super::fit::{self, TagFit};
use super::search::Found;
use super::seen::{SeenTag, middle_px, shortest_side_px};
use scaleproof_core::geometry::distance;
use scaleproof_photo::Luma;

/// Tags found by several searches.
#[derive(Default)]
pub(super) struct MergedTags {
    fits: Vec<TagFit>,
    /// Positions where two searches read different ids.
    contradicted: Vec<[f64; 2]>,
}

impl MergedTags {
    /// Adds the result of one more search.
    ///
    /// The same id twice in one place is one tag, and the first search's is kept unless its sides could not be fitted. The same id in two places is
    /// two tags, neither of which is used for a pose. Different ids in one place contradict each other, and both are dropped.
    pub(super) fn add(&mut self, found: Vec<Found>, luma: &dyn Luma) {
        for new in found {
            let known = self.here(&new).map(|i| &self.fits[i]);
            if !known.is_some_and(|known| is_same(&known.found, &new) && known.is_fitted()) {
                self.add_fit(TagFit::new(new, luma));
            }
        }
    }

    /// Adds a tag that is fitted already, by the rules of [`Self::add`].
    pub(super) fn add_fit(&mut self, new: TagFit) {
        let (place, reach) = (middle_px(&new.found.corners_px), half_side(&new.found));
        if self.contradicted.iter().any(|known| distance(*known, place) < reach) {
            return;
        }
        match self.here(&new.found) {
            None => self.fits.push(new),
            Some(i) if !is_same(&self.fits[i].found, &new.found) => {
                self.contradicted.push(place);
                self.fits.remove(i);
            }
            Some(i) if !self.fits[i].is_fitted() => self.fits[i] = new,
            Some(_) => {}
        }
    }

    /// Returns the index of the known tag at a tag's position.
    fn here(&self, tag: &Found) -> Option<usize> {
        let (place, reach) = (middle_px(&tag.corners_px), half_side(tag));
        let is_here = |known: &TagFit| distance(middle_px(&known.found.corners_px), place) < reach;
        self.fits.iter().position(is_here)
    }

    pub(super) fn seen(&self) -> Vec<SeenTag> {
        fit::seen(self.fits.iter())
    }

    /// Returns only the tags whose sides were all fitted. The corners of the others may be off by more than any pose tolerates.
    pub(super) fn fitted(&self) -> Vec<SeenTag> {
        fit::seen(self.fits.iter().filter(|fit| fit.is_fitted()))
    }
}

fn is_same(a: &Found, b: &Found) -> bool {
    (a.family, a.id) == (b.family, b.id)
}

fn half_side(found: &Found) -> f64 {
    shortest_side_px(&found.corners_px) / 2.0
}
