//! The tag detectors that need OpenCV and locus-core, for comparison and as stages of the cascade: the feature `full` has them.

#[cfg(feature = "full")]
mod built {
    use super::super::search::{Enlarged, Search};
    use super::super::{ArucoOpenCv, ArucoRefiner, CornersBy, Locus, StartError, TagDetector, TagDetectorChoice};
    use crate::scene::TagFamily;

    type Searches = Result<Vec<Box<dyn Search>>, StartError>;

    /// What the cascade asks before C AprilTag, the fastest first.
    pub(in super::super) fn fast(families: &[TagFamily]) -> Searches {
        let (of_locus, of_opencv) = read(families);
        let mut searches: Vec<Box<dyn Search>> = Vec::new();
        if !of_locus.is_empty() {
            searches.push(Box::new(Locus::unrefined(&of_locus)?));
        }
        if !of_opencv.is_empty() {
            searches.push(Box::new(ArucoOpenCv::new(&of_opencv, ArucoRefiner::None)?));
        }
        Ok(searches)
    }

    /// What finds tags in noise and blur that the others miss.
    pub(in super::super) fn for_noise(families: &[TagFamily]) -> Searches {
        let (of_locus, _) = read(families);
        Ok(if of_locus.is_empty() {
            Vec::new()
        } else {
            vec![Box::new(Locus::for_noise(&of_locus)?)]
        })
    }

    /// What finds small tags that the others miss.
    pub(in super::super) fn for_small_tags(families: &[TagFamily]) -> Searches {
        let (_, of_opencv) = read(families);
        Ok(if of_opencv.is_empty() {
            Vec::new()
        } else {
            vec![Box::new(Enlarged(ArucoOpenCv::new(&of_opencv, ArucoRefiner::None)?))]
        })
    }

    /// The families that locus-core and OpenCV read.
    fn read(families: &[TagFamily]) -> (Vec<TagFamily>, Vec<TagFamily>) {
        let by = |choice: TagDetectorChoice| families.iter().copied().filter(|f| choice.reads(*f)).collect();
        (
            by(TagDetectorChoice::Locus(CornersBy::Fit)),
            by(TagDetectorChoice::Aruco(ArucoRefiner::None, CornersBy::Fit)),
        )
    }

    /// Names and versions of the libraries above, for a result's provenance.
    pub(in super::super) fn libraries() -> String {
        let opencv = opencv_version().unwrap_or_default();
        format!("locus-core {}, OpenCV {opencv}, ", Locus::VERSION)
    }

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
    use super::super::search::Search;
    use super::super::{ArucoRefiner, CornersBy, StartError, TagDetector, TagDetectorChoice};
    use crate::scene::TagFamily;

    type Searches = Result<Vec<Box<dyn Search>>, StartError>;

    pub(in super::super) fn fast(_: &[TagFamily]) -> Searches {
        Ok(Vec::new())
    }

    pub(in super::super) fn for_noise(_: &[TagFamily]) -> Searches {
        Ok(Vec::new())
    }

    pub(in super::super) fn for_small_tags(_: &[TagFamily]) -> Searches {
        Ok(Vec::new())
    }

    pub(in super::super) fn libraries() -> String {
        String::new()
    }

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

pub(super) use built::{aruco, fast, for_noise, for_small_tags, libraries, locus, opencv_version};
