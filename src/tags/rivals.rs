//! The tag detectors that are there for comparison, and what they need OpenCV and locus-core for: the feature `full` has them.

use crate::scene::TagFamily;

/// OpenCV and locus-core know these codes of the AprilTag families.
pub(super) fn aruco_reads(family: TagFamily) -> bool {
    matches!(family, TagFamily::Tag16h5 | TagFamily::Tag25h9 | TagFamily::Tag36h11)
}

pub(super) fn locus_reads(family: TagFamily) -> bool {
    matches!(family, TagFamily::Tag16h5 | TagFamily::Tag36h11)
}

#[cfg(feature = "full")]
mod built {
    use super::super::{ArucoOpenCv, ArucoRefiner, CornersBy, Locus, StartError, TagDetector};
    use super::TagFamily;

    pub(in super::super) fn aruco(
        families: &[TagFamily],
        refiner: ArucoRefiner,
        by: CornersBy,
    ) -> Result<Box<dyn TagDetector>, StartError> {
        Ok(by.open(ArucoOpenCv::new(families, refiner)?))
    }

    pub(in super::super) fn locus(families: &[TagFamily], by: CornersBy) -> Result<Box<dyn TagDetector>, StartError> {
        Ok(by.open(Locus::new(families)?))
    }

    /// The version of the OpenCV that this program runs with; `None` in a build without it.
    pub(in super::super) fn opencv_version() -> Option<String> {
        opencv::core::get_version_string().ok()
    }
}

#[cfg(not(feature = "full"))]
mod built {
    use super::super::{ArucoRefiner, CornersBy, StartError, TagDetector, TagDetectorChoice};
    use super::TagFamily;

    pub(in super::super) fn aruco(
        _: &[TagFamily],
        refiner: ArucoRefiner,
        by: CornersBy,
    ) -> Result<Box<dyn TagDetector>, StartError> {
        let detector = TagDetectorChoice::Aruco(refiner, by);
        Err(StartError::NotBuilt { detector })
    }

    pub(in super::super) fn locus(_: &[TagFamily], by: CornersBy) -> Result<Box<dyn TagDetector>, StartError> {
        let detector = TagDetectorChoice::Locus(by);
        Err(StartError::NotBuilt { detector })
    }

    /// The version of the OpenCV that this program runs with; `None` in a build without it.
    pub(in super::super) fn opencv_version() -> Option<String> {
        None
    }
}

pub(super) use built::{aruco, locus, opencv_version};
