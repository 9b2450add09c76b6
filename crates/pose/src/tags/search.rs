//! Tag search by a library: tags with the library's own corners.

use image::GrayImage;

use super::{SeenTag, TagDetector};
use crate::scene::TagFamily;
use scaleproof_photo::Luma;

/// Tag as a library found it, before its sides are fitted and its border is tested.
pub(super) struct Found {
    pub family: TagFamily,
    pub id: u32,
    /// Corners in this project's order and pixel convention.
    pub corners_px: [[f64; 2]; 4],
}

/// Strength for which the cascade uses a library.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Strength {
    Speed,
    /// Finds tags in noise and blur that the others miss.
    Noise,
    /// Finds small tags that the others miss.
    SmallTags,
}

pub(super) trait Search {
    /// Returns every tag of the library's families in an image that the library can search.
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found>;

    /// Returns every tag of the library's families, in any order: none in a tiny image; a huge one is searched at reduced size.
    fn search(&mut self, grey: &GrayImage) -> Vec<Found> {
        let factor = library_reduction(grey);
        factor.map_or_else(Vec::new, |factor| {
            reduced_by(grey, factor, |grey| self.search_all(grey))
        })
    }
}

/// Detector with a library's own corners.
impl<S: Search> TagDetector for S {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let grey = luma.whole();
        let seen = |tag: &Found| SeenTag::new(tag.family, tag.id, tag.corners_px, grey);
        self.search(grey).iter().map(seen).collect()
    }
}

/// Minimum side of a searched image, px: the smallest tag has 6 modules across, its white ring 8, and libraries need some 2 px for each. Their code
/// does not handle smaller images: C AprilTag reads out of bounds in an image with a side below 4 px (`fuzz/sanitize.sh raw`).
const LEAST_SIDE_PX: u32 = 16;

/// Maximum number of searched pixels; larger images are reduced. A library takes some 0.3 µs and 26 bytes for each pixel of fine texture, and a
/// 200-megapixel camera shows no smaller tags than one of 33.
const MOST_SEARCHED_PX: u64 = 34_000_000;

/// Returns the integer factor by which an image is reduced before a library searches it; `None` if too little of it is left.
pub fn library_reduction(grey: &GrayImage) -> Option<u32> {
    let factor = least_reduction(grey, MOST_SEARCHED_PX);
    (grey.width().min(grey.height()) / factor >= LEAST_SIDE_PX).then_some(factor)
}

/// Returns the smallest integer factor that reduces an image to at most `most_px` pixels, and to sides that fit signed 16 bits: C AprilTag aborts the
/// program at longer ones, and OpenCV refuses them.
pub fn least_reduction(grey: &GrayImage, most_px: u64) -> u32 {
    let pixels = u64::from(grey.width()) * u64::from(grey.height());
    let longest = grey.width().max(grey.height());
    let fits = |f: &u32| pixels / (u64::from(*f) * u64::from(*f)) <= most_px && longest / f < i16::MAX as u32;
    (1u32..).find(fits).unwrap_or(1)
}

/// Searches an image reduced by an integer factor; corners are in pixels of the whole image.
pub(super) fn reduced_by(luma: &dyn Luma, factor: u32, mut search: impl FnMut(&GrayImage) -> Vec<Found>) -> Vec<Found> {
    if factor == 1 {
        return search(luma.whole());
    }
    let mut found = search(&luma.reduced(factor));
    for tag in &mut found {
        tag.corners_px = tag.corners_px.map(|corner| enlarged(corner, factor));
    }
    found
}

/// Converts a position in a reduced image to the whole one: pixel 0 of the reduced image covers pixels 0 to `factor` − 1.
pub fn enlarged(place_px: [f64; 2], factor: u32) -> [f64; 2] {
    place_px.map(|v| (v + 0.5) * f64::from(factor) - 0.5)
}
