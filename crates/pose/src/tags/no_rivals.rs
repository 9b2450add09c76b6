//! What stands in for [`super::rivals`] in a build without the feature `full`: no tag detectors.

use super::search::{Search, Strength};
use super::{StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;

/// The version of the OpenCV that this program runs with: this build has none.
pub fn opencv_version() -> Option<String> {
    None
}

/// Names and versions of the detectors that the cascade uses besides C AprilTag: this build has none.
pub(super) fn libraries() -> String {
    String::new()
}

/// The finders that the cascade uses for their strength: this build has none.
pub(super) fn finders(_: Strength, _: &[TagFamily]) -> Result<Vec<Box<dyn Search>>, StartError> {
    Ok(Vec::new())
}

/// Refuses a detector that this build does not have.
pub(super) fn open(detector: TagDetectorChoice, _: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
    Err(StartError::NotBuilt { detector })
}
