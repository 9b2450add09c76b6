//! The default: tags are found on a reduced image, their corners fitted at full size.

use super::apriltag_c::AprilTagC;
use super::fit::fitted;
use super::search::{Search, reduced_by};
use super::{SeenTag, StartError, TagDetector};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// The long side of the image that is searched. Below it nothing is reduced.
const SEARCHED_PX: u32 = 1600;

/// The long side of a live image that is searched, px: the answer must come soon, and the next image brings another chance.
const SEARCHED_LIVE_PX: u32 = 640;

/// With so many whole tags a pose is beyond doubt, and the small ones that a reduced image hides are not missed.
const ENOUGH_TAGS: usize = 2;

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
