//! Replacement of [`super::rivals`] in a build without the feature `full`: no tag detectors.

use super::search::{Search, Strength};
use super::{StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;
use scaleproof_core::message::bail;

/// Returns the version of OpenCV at run time: none in this build.
pub fn opencv_version() -> Option<String> {
    None
}

/// Returns names and versions of the cascade's detectors besides C AprilTag: none in this build.
pub(super) fn libraries() -> String {
    String::new()
}

/// Returns the cascade's finders of this strength: none in this build.
pub(super) fn finders(_: Strength, _: &[TagFamily]) -> Result<Vec<Box<dyn Search>>, StartError> {
    Ok(Vec::new())
}

/// Returns an error: this build does not have the detector.
pub(super) fn open(detector: TagDetectorChoice, _: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
    bail!(
        "this build of scaleproof has no tag detector {detector}: it was built without the feature `full`";
        hint: "leave ‹tag_detector› out"
    )
}
