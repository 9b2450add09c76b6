//! What stands in for [`super::rivals`] in a build without the feature `full`: no tag detectors.

use super::search::Search;
use super::{StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;

type Searches = Result<Vec<Box<dyn Search>>, StartError>;

/// The version of the OpenCV that this program runs with: this build has none.
pub fn opencv_version() -> Option<String> {
    None
}

/// Names and versions of the detectors that the cascade asks before C AprilTag: this build has none.
pub(super) fn libraries() -> String {
    String::new()
}

/// The cascade's fast finders: this build has none.
pub(super) fn fast(_: &[TagFamily]) -> Searches {
    Ok(Vec::new())
}

/// The cascade's finders in noise and blur: this build has none.
pub(super) fn for_noise(_: &[TagFamily]) -> Searches {
    Ok(Vec::new())
}

/// The cascade's finders of small tags: this build has none.
pub(super) fn for_small_tags(_: &[TagFamily]) -> Searches {
    Ok(Vec::new())
}

/// Refuses a detector that this build does not have.
pub(super) fn open(detector: TagDetectorChoice, _: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
    Err(StartError::NotBuilt { detector })
}
