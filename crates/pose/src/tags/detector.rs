//! Detectors of tags, as the rest of the program sees them.

use super::missing::StillMissing;
use super::seen::SeenTag;
use scaleproof_photo::Luma;

/// Detector that finds tags in a photo.
pub trait TagDetector {
    /// Returns every tag of the detector's families, in any order.
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag>;

    /// Like [`TagDetector::find`], but asks `missing` which tags are left to find: a detector that could search longer stops if nothing is missing,
    /// and searches at the predicted positions.
    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        let _ = missing;
        self.find(luma)
    }
}

impl TagDetector for Box<dyn TagDetector> {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        (**self).find(luma)
    }

    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        (**self).find_until(luma, missing)
    }
}
