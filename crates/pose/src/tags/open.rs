//! Detectors made of a choice.

use super::apriltag_c::AprilTagC;
use super::cascade::{Cascade, CoarseToFine};
use super::choice::{StartError, TagDetectorChoice};
use super::detector::TagDetector;
use super::rivals;
use crate::scene::TagFamily;

impl TagDetectorChoice {
    /// Creates a detector for some families. Not to be shared between threads: each makes its own.
    ///
    /// # Errors
    /// A family the detector does not read; a library that does not start.
    pub fn open(self, families: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
        self.check_families(families)?;
        Ok(match self {
            TagDetectorChoice::Cascade => Box::new(Cascade::new(families)?),
            TagDetectorChoice::CoarseToFine => Box::new(CoarseToFine::new(families)?),
            TagDetectorChoice::AprilTagC(by) => by.open(AprilTagC::new(families)?),
            TagDetectorChoice::Aruco(_) | TagDetectorChoice::Locus => rivals::open(self, families)?,
        })
    }

    /// Creates a faster detector for live images, if there is one. Its results are for display; results to keep come from [`Self::open`].
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn open_live(self, families: &[TagFamily]) -> Result<Option<Box<dyn TagDetector>>, StartError> {
        match self {
            TagDetectorChoice::Cascade => Ok(Some(Box::new(Cascade::live(families)?))),
            TagDetectorChoice::CoarseToFine => Ok(Some(Box::new(CoarseToFine::live(families)?))),
            _ => Ok(None),
        }
    }

    /// Returns name and version, for a result's provenance.
    pub fn provenance(self) -> String {
        match self {
            TagDetectorChoice::Cascade => format!("{self} of {}{}", rivals::libraries(), AprilTagC::PROVENANCE),
            TagDetectorChoice::CoarseToFine | TagDetectorChoice::AprilTagC(_) => {
                format!("{self} on {}", AprilTagC::PROVENANCE)
            }
            TagDetectorChoice::Aruco(_) => {
                format!("{self} of OpenCV {}", rivals::opencv_version().unwrap_or_default())
            }
            TagDetectorChoice::Locus => format!("{self} on locus-core 0.10"),
        }
    }
}
