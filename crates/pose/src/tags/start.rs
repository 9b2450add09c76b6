//! From the choice of a tag detector to the detector.

use super::{AprilTagC, Cascade, CoarseToFine, StartError, TagDetector, TagDetectorChoice, rivals};
use crate::scene::TagFamily;

impl TagDetectorChoice {
    /// A detector for some families. It is not to be shared between threads: each makes its own.
    ///
    /// # Errors
    /// A family the detector does not read; a library that does not start.
    pub fn open(self, families: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
        self.check_families(families)?;
        Ok(match self {
            TagDetectorChoice::Cascade => Box::new(Cascade::new(families)?),
            TagDetectorChoice::CoarseToFine => Box::new(CoarseToFine::new(families)?),
            TagDetectorChoice::AprilTagC(by) => by.open(AprilTagC::new(families)?),
            TagDetectorChoice::Aruco(..) | TagDetectorChoice::Locus(_) => rivals::open(self, families)?,
        })
    }

    /// A faster search for live images, where there is one. What it finds may be shown; what is kept is found by [`Self::open`].
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

    /// Name and version, for a result's provenance.
    pub fn provenance(self) -> String {
        match self {
            TagDetectorChoice::Cascade => format!("{self} of {}{}", rivals::libraries(), AprilTagC::PROVENANCE),
            TagDetectorChoice::CoarseToFine | TagDetectorChoice::AprilTagC(_) => {
                format!("{self} on {}", AprilTagC::PROVENANCE)
            }
            TagDetectorChoice::Aruco(..) => {
                format!("{self} of OpenCV {}", rivals::opencv_version().unwrap_or_default())
            }
            TagDetectorChoice::Locus(_) => format!("{self} on locus-core 0.10"),
        }
    }
}
