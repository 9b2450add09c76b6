//! The default before the cascade: tags are found on a reduced image, their corners fitted at full size.

use super::apriltag_c::AprilTagC;
use super::cascade::{ENOUGH_TAGS, SEARCHED_LIVE_PX, SEARCHED_PX};
use super::fit::fitted;
use super::search::{Search, reduced_by};
use super::{SeenTag, StartError, TagDetector};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// C AprilTag on a reduced image, and our own corners. Holds C memory, so each thread makes its own.
pub struct CoarseToFine {
    search: AprilTagC,
    searched_px: u32,
    /// With fewer whole tags the image is searched again at full size.
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

    /// A faster one, which misses small tags: it searches a smaller image, and never twice.
    pub fn live(families: &[TagFamily]) -> Result<CoarseToFine, StartError> {
        Ok(CoarseToFine {
            searched_px: SEARCHED_LIVE_PX,
            enough_tags: 0,
            ..CoarseToFine::new(families)?
        })
    }

    fn find_reduced(&mut self, luma: &dyn Luma, factor: u32) -> Vec<SeenTag> {
        fitted(reduced_by(luma, factor, |small| self.search.search(small)), luma)
    }
}

impl TagDetector for CoarseToFine {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        let [width, height] = luma.size();
        let factor = width.max(height).div_ceil(self.searched_px).max(1);
        let tags = self.find_reduced(luma, factor);
        if factor > 1 && tags.iter().filter(|tag| tag.is_whole).count() < self.enough_tags {
            return self.find_reduced(luma, 1);
        }
        tags
    }
}
