//! What a library makes of an image: tags with corners of its own.

use image::GrayImage;

use super::{SeenTag, TagDetector};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// A tag as a library found it, before its sides were fitted and its border was looked at.
pub(super) struct Found {
    pub family: TagFamily,
    pub id: u32,
    /// In this project's order and pixel convention.
    pub corners_px: [[f64; 2]; 4],
}

/// What the cascade uses a library for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Strength {
    Speed,
    /// It finds tags in noise and blur that the others miss.
    Noise,
    /// It finds small tags that the others miss.
    SmallTags,
}

pub(super) trait Search {
    /// Every tag of the library's families in an image that the library can search.
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found>;

    /// Every tag of the library's families, in any order: none in a tiny image, and a huge one is searched reduced.
    fn search(&mut self, grey: &GrayImage) -> Vec<Found> {
        let factor = library_reduction(grey);
        factor.map_or_else(Vec::new, |factor| {
            reduced_by(grey, factor, |grey| self.search_all(grey))
        })
    }
}

/// A library's tags with its own corners.
impl<S: Search> TagDetector for S {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let grey = luma.whole();
        let seen = |tag: &Found| SeenTag::new(tag.family, tag.id, tag.corners_px, grey);
        self.search(grey).iter().map(seen).collect()
    }
}

/// No tag of any family fits a smaller image: the least has 6 modules across, its white ring 8, and libraries need some 2 px for each. Their
/// code is not made for such images either: C AprilTag reads beyond an image with a side below 4 px (`fuzz/sanitize.sh raw`).
const LEAST_SIDE_PX: u32 = 16;

/// Larger images are searched reduced. A library takes some 0.3 µs and 26 bytes for each pixel of fine texture, and the camera of 200
/// megapixels shows no smaller tags than one of 33.
const MOST_SEARCHED_PX: u64 = 34_000_000;

/// The whole factor by which an image is reduced before a library searches it; `None` where that leaves too little of it.
pub fn library_reduction(grey: &GrayImage) -> Option<u32> {
    let factor = least_reduction(grey, MOST_SEARCHED_PX);
    (grey.width().min(grey.height()) / factor >= LEAST_SIDE_PX).then_some(factor)
}

/// The least whole factor by which an image has to be reduced to have at most so many pixels, and sides that fit 16 bits with a sign: C
/// AprilTag ends the program at longer ones, and OpenCV refuses them.
pub fn least_reduction(grey: &GrayImage, most_px: u64) -> u32 {
    let pixels = u64::from(grey.width()) * u64::from(grey.height());
    let longest = grey.width().max(grey.height());
    let fits = |f: &u32| pixels / (u64::from(*f) * u64::from(*f)) <= most_px && longest / f < i16::MAX as u32;
    (1u32..).find(fits).unwrap_or(1)
}

/// Searches an image reduced by a whole factor; corners are in pixels of the whole image.
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

/// A place of a reduced image in the whole one: pixel 0 of the reduced image covers pixels 0 to `factor` − 1.
pub fn enlarged(place_px: [f64; 2], factor: u32) -> [f64; 2] {
    place_px.map(|v| (v + 0.5) * f64::from(factor) - 0.5)
}
