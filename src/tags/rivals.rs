//! The tag detectors that are there for comparison, and what they need OpenCV and locus-core for: the feature `full` has them.

#[cfg(feature = "full")]
mod built {
    use super::super::{ArucoOpenCv, ArucoRefiner, CornersBy, Locus, StartError, TagDetector};
    use crate::scene::TagFamily;

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
    use crate::scene::TagFamily;

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
