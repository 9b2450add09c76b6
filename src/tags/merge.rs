//! The tags of several searches of one photo as one list: each is fitted once.

use image::GrayImage;

use super::SeenTag;
use super::fit::{self, TagFit};
use super::search::Found;
use crate::geometry::distance;

/// What several searches found.
#[derive(Default)]
pub(super) struct MergedTags {
    fits: Vec<TagFit>,
    /// Where two searches read different ids.
    contradicted: Vec<[f64; 2]>,
}

impl MergedTags {
    /// Adds what one more search found.
    ///
    /// The same id in the same place is one tag, and the first search's stays unless its sides were not seen. The same id in two places is two
    /// tags, of which no pose uses either. Different ids in one place contradict each other, and no search is believed there.
    pub(super) fn add(&mut self, found: Vec<Found>, grey: &GrayImage) {
        for new in found {
            let place = middle(&new);
            let is_here = |known: &[f64; 2]| distance(*known, place) < half_side(&new);
            if self.contradicted.iter().any(is_here) {
                continue;
            }
            match self.fits.iter().position(|known| is_here(&middle(&known.found))) {
                None => self.fits.push(TagFit::new(new, grey)),
                Some(i) if is_same(&self.fits[i].found, &new) => {
                    if !self.fits[i].is_fitted() {
                        self.fits[i] = TagFit::new(new, grey);
                    }
                }
                Some(i) => {
                    self.contradicted.push(place);
                    self.fits.remove(i);
                }
            }
        }
    }

    /// The tags with the corners of their fits.
    pub(super) fn seen(&self, grey: &GrayImage) -> Vec<SeenTag> {
        fit::seen(self.fits.iter(), grey)
    }

    /// Only those whose sides were all seen. The corners of the others may be off by more than any pose allows for.
    pub(super) fn fitted(&self, grey: &GrayImage) -> Vec<SeenTag> {
        fit::seen(self.fits.iter().filter(|fit| fit.is_fitted()), grey)
    }
}

fn is_same(a: &Found, b: &Found) -> bool {
    (a.family, a.id) == (b.family, b.id)
}

fn middle(found: &Found) -> [f64; 2] {
    [0, 1].map(|k| found.corners_px.iter().map(|c| c[k]).sum::<f64>() / 4.0)
}

fn half_side(found: &Found) -> f64 {
    let c = &found.corners_px;
    let sides = (0..4).map(|i| distance(c[i], c[(i + 1) % 4]));
    sides.fold(f64::INFINITY, f64::min) / 2.0
}
