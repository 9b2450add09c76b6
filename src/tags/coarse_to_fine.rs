//! The default: tags are found on a reduced picture, their corners fitted at full size.

use image::GrayImage;

use super::apriltag_c::AprilTagC;
use super::fit::fitted;
use super::search::Search;
use super::{SeenTag, StartError, TagDetector};
use crate::scene::TagFamily;

/// The long side of the picture that is searched. Below it nothing is reduced.
const SEARCHED_PX: u32 = 1600;

/// The same for live pictures, where the answer must come soon and the next picture brings another chance.
const SEARCHED_LIVE_PX: u32 = 640;

/// With so many whole tags a pose is beyond doubt, and the small ones that a reduced picture hides are not missed.
const ENOUGH_TAGS: usize = 2;

/// C AprilTag on a reduced picture, and our own corners. Holds C memory, so each thread makes its own.
pub struct CoarseToFine {
    search: AprilTagC,
    searched_px: u32,
    /// With fewer whole tags the picture is searched again at full size.
    enough_tags: usize,
}

impl CoarseToFine {
    /// A detector for some families.
    pub fn new(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            search: AprilTagC::new(families)?,
            searched_px: SEARCHED_PX,
            enough_tags: ENOUGH_TAGS,
        })
    }

    /// A faster one, which misses small tags: it searches a smaller picture, and never twice.
    pub fn live(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            searched_px: SEARCHED_LIVE_PX,
            enough_tags: 0,
            ..CoarseToFine::new(families)?
        })
    }

    fn find_reduced(&mut self, grey: &GrayImage, factor: u32) -> Vec<SeenTag> {
        if factor == 1 {
            return fitted(self.search.search(grey), grey);
        }
        let mut found = self.search.search(&reduced(grey, factor));
        // Pixel 0 of the reduced picture covers pixels 0 to factor − 1.
        let enlarged = |v: f64| (v + 0.5) * f64::from(factor) - 0.5;
        for tag in &mut found {
            tag.corners_px = tag.corners_px.map(|corner| corner.map(enlarged));
        }
        fitted(found, grey)
    }
}

impl TagDetector for CoarseToFine {
    fn find(&mut self, grey: &GrayImage) -> Vec<SeenTag> {
        let factor = grey.width().max(grey.height()).div_ceil(self.searched_px);
        let tags = self.find_reduced(grey, factor);
        if factor > 1 && tags.iter().filter(|tag| tag.is_whole).count() < self.enough_tags {
            return self.find_reduced(grey, 1);
        }
        tags
    }
}

/// Means over squares of `factor` × `factor` pixels; a rest at the right and at the bottom is left out.
fn reduced(grey: &GrayImage, factor: u32) -> GrayImage {
    let (width, height) = (grey.width() / factor, grey.height() / factor);
    let (f, w) = (factor as usize, width as usize);
    let stride = grey.width() as usize;
    let mut bytes = Vec::with_capacity(w * height as usize);
    let mut sums = vec![0u32; w];
    for rows in grey.as_raw().chunks_exact(stride * f) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, pixels) in sums.iter_mut().zip(row.chunks_exact(f)) {
                *sum += pixels.iter().map(|p| u32::from(*p)).sum::<u32>();
            }
        }
        let area = factor * factor;
        bytes.extend(sums.iter().map(|sum| ((sum + area / 2) / area) as u8));
    }
    GrayImage::from_raw(width, height, bytes).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reducing_takes_means_and_leaves_the_rest_out() {
        let picture = GrayImage::from_fn(7, 5, |x, y| image::Luma([(10 * x + y) as u8]));
        let small = reduced(&picture, 2);
        assert_eq!(small.dimensions(), (3, 2));
        assert_eq!(small.as_raw(), &[6, 26, 46, 8, 28, 48]); // 5.5 and so on, rounded up
    }
}
