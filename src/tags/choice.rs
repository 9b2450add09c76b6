//! The tag detectors by name.

use std::fmt;
use std::str::FromStr;

use super::{AprilTagC, ArucoOpenCv, ArucoRefiner, CoarseToFine, Locus, TagDetector};
use crate::scene::TagFamily;

/// A tag detector that can be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum TagDetectorChoice {
    /// C AprilTag on a reduced picture, corners fitted at full size. The default: the knee of the table in `docs/lessons.md`.
    #[default]
    CoarseToFine,
    /// C AprilTag at full size, with its own corners.
    AprilTagC,
    /// OpenCV's ArUco detector at full size.
    Aruco(ArucoRefiner),
    /// locus-core at full size.
    Locus,
}

/// Why a tag detector could not start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StartError {
    #[error("the tag detector '{name}' is not known; use one of {}", names(TagDetectorChoice::ALL.iter()))]
    Unknown { name: String },
    #[error(
        "the tag detector {detector} cannot read tags of the family {}: use one of {}",
        family_name(*family),
        names(TagDetectorChoice::ALL.iter().filter(|d| d.reads(*family)))
    )]
    Family {
        detector: TagDetectorChoice,
        family: TagFamily,
    },
    #[error("the tag detector {detector} could not start: {reason}")]
    Library {
        detector: TagDetectorChoice,
        reason: String,
    },
}

impl TagDetectorChoice {
    /// Every detector; the default first.
    pub const ALL: [TagDetectorChoice; 7] = [
        TagDetectorChoice::CoarseToFine,
        TagDetectorChoice::AprilTagC,
        TagDetectorChoice::Aruco(ArucoRefiner::None),
        TagDetectorChoice::Aruco(ArucoRefiner::Subpix),
        TagDetectorChoice::Aruco(ArucoRefiner::Contour),
        TagDetectorChoice::Aruco(ArucoRefiner::AprilTag),
        TagDetectorChoice::Locus,
    ];

    /// The name it is chosen by.
    pub fn name(self) -> &'static str {
        match self {
            TagDetectorChoice::CoarseToFine => "coarse-to-fine",
            TagDetectorChoice::AprilTagC => "apriltag",
            TagDetectorChoice::Aruco(ArucoRefiner::None) => "aruco",
            TagDetectorChoice::Aruco(ArucoRefiner::Subpix) => "aruco-subpix",
            TagDetectorChoice::Aruco(ArucoRefiner::Contour) => "aruco-contour",
            TagDetectorChoice::Aruco(ArucoRefiner::AprilTag) => "aruco-apriltag",
            TagDetectorChoice::Locus => "locus",
        }
    }

    /// Whether it knows a family's codes.
    pub fn reads(self, family: TagFamily) -> bool {
        match self {
            TagDetectorChoice::CoarseToFine | TagDetectorChoice::AprilTagC => true,
            TagDetectorChoice::Aruco(_) => ArucoOpenCv::reads(family),
            TagDetectorChoice::Locus => Locus::reads(family),
        }
    }

    /// A detector for some families. It is not to be shared between threads: each makes its own.
    ///
    /// # Errors
    /// A family the detector does not read; a library that does not start.
    pub fn open(self, families: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
        Ok(match self {
            TagDetectorChoice::CoarseToFine => Box::new(CoarseToFine::new(families)?),
            TagDetectorChoice::AprilTagC => Box::new(AprilTagC::new(families)?),
            TagDetectorChoice::Aruco(refiner) => Box::new(ArucoOpenCv::new(families, refiner)?),
            TagDetectorChoice::Locus => Box::new(Locus::new(families)?),
        })
    }

    /// Name and version, for a result's provenance.
    pub fn provenance(self) -> String {
        match self {
            TagDetectorChoice::CoarseToFine => format!("{self} on {}", AprilTagC::PROVENANCE),
            TagDetectorChoice::AprilTagC => AprilTagC::PROVENANCE.to_owned(),
            TagDetectorChoice::Aruco(_) => format!(
                "{self} of OpenCV {}",
                opencv::core::get_version_string().unwrap_or_default()
            ),
            TagDetectorChoice::Locus => "locus-core 0.10".to_owned(),
        }
    }

    /// The error for the first family a detector cannot read.
    pub(super) fn check_families(self, families: &[TagFamily]) -> Result<(), StartError> {
        match families.iter().find(|family| !self.reads(**family)) {
            None => Ok(()),
            Some(family) => Err(StartError::Family {
                detector: self,
                family: *family,
            }),
        }
    }

    /// A library's own error.
    pub(super) fn failed(self, reason: impl fmt::Display) -> StartError {
        StartError::Library {
            detector: self,
            reason: reason.to_string(),
        }
    }
}

impl fmt::Display for TagDetectorChoice {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for TagDetectorChoice {
    type Err = StartError;

    fn from_str(name: &str) -> Result<Self, StartError> {
        let known = TagDetectorChoice::ALL.into_iter().find(|choice| choice.name() == name);
        known.ok_or_else(|| StartError::Unknown { name: name.to_owned() })
    }
}

fn names<'a>(choices: impl Iterator<Item = &'a TagDetectorChoice>) -> String {
    choices.map(|choice| choice.name()).collect::<Vec<_>>().join(", ")
}

fn family_name(family: TagFamily) -> &'static str {
    let named = TagFamily::ALL.iter().find(|(known, _)| *known == family);
    named.map_or("of this scene", |(_, name)| name)
}
