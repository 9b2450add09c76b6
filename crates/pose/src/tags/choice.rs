//! Choice of a tag detector by name.

use std::fmt;
use std::str::FromStr;

use CornersBy::{Fit, Library};

use super::TagDetector;
use super::fit::WithFittedCorners;
use super::search::Search;
use crate::scene::TagFamily;
use scaleproof_core::message::{Message, message};
use scaleproof_core::spelling;

/// A tag detector that can be chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum TagDetectorChoice {
    /// The fast finders first, the others for what they missed; corners fitted at full size. The default: `docs/lessons/poses.md`.
    #[default]
    Cascade,
    /// C AprilTag on a reduced image, corners fitted at full size.
    CoarseToFine,
    /// C AprilTag at full size.
    AprilTagC(CornersBy),
    /// OpenCV's ArUco detector at full size.
    Aruco(CornersBy),
    /// locus-core at full size.
    Locus,
}

/// Source of a found tag's corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CornersBy {
    /// The fit common to all choices, so that they differ only in which tags they find.
    Fit,
    /// The library that found the tag, OpenCV by `cornerSubPix`. For comparison: the yaw of a tag then differs by up to 1.5° between libraries.
    Library,
}

/// Reason why a tag detector could not start.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct StartError(#[from] Message);

impl TagDetectorChoice {
    /// Detectors that can be chosen by name, the default first; their corners are all fitted alike.
    pub const ALL: [TagDetectorChoice; 5] = [
        TagDetectorChoice::Cascade,
        TagDetectorChoice::CoarseToFine,
        TagDetectorChoice::AprilTagC(Fit),
        TagDetectorChoice::Aruco(Fit),
        TagDetectorChoice::Locus,
    ];

    /// Libraries with their own corners, for comparison in charts.
    pub const PEERS: [TagDetectorChoice; 2] =
        [TagDetectorChoice::AprilTagC(Library), TagDetectorChoice::Aruco(Library)];

    /// Returns the name by which the detector is chosen.
    pub fn name(self) -> &'static str {
        match self {
            TagDetectorChoice::Cascade => "cascade",
            TagDetectorChoice::CoarseToFine => "coarse-to-fine",
            TagDetectorChoice::AprilTagC(Fit) => "apriltag",
            TagDetectorChoice::Aruco(Fit) => "aruco",
            TagDetectorChoice::Locus => "locus",
            TagDetectorChoice::AprilTagC(Library) => "apriltag-own",
            TagDetectorChoice::Aruco(Library) => "aruco-own",
        }
    }

    /// Returns true if the detector can read the family.
    pub fn reads(self, family: TagFamily) -> bool {
        match self {
            TagDetectorChoice::Cascade | TagDetectorChoice::CoarseToFine | TagDetectorChoice::AprilTagC(_) => true,
            TagDetectorChoice::Aruco(_) => {
                matches!(family, TagFamily::Tag16h5 | TagFamily::Tag25h9 | TagFamily::Tag36h11)
            }
            TagDetectorChoice::Locus => matches!(family, TagFamily::Tag16h5 | TagFamily::Tag36h11),
        }
    }

    /// Returns an error for families that the detector cannot read.
    pub(super) fn check_families(self, families: &[TagFamily]) -> Result<(), StartError> {
        match families.iter().find(|family| !self.reads(**family)) {
            None => Ok(()),
            Some(family) => Err(StartError(message!(
                "the tag detector {self} cannot read tags of the family {}: use one of {}",
                family.name(),
                names(TagDetectorChoice::ALL.iter().filter(|d| d.reads(*family)))
            ))),
        }
    }

    /// Starts a library's detector for each family, since libraries do not say which family a tag belongs to.
    pub(super) fn for_each_family<D, E: fmt::Display>(
        self,
        families: &[TagFamily],
        start: impl Fn(TagFamily) -> Result<D, E>,
    ) -> Result<Vec<(TagFamily, D)>, StartError> {
        self.check_families(families)?;
        let started = families.iter().map(|family| Ok((*family, start(*family)?)));
        started
            .collect::<Result<_, E>>()
            .map_err(|reason| StartError(message!("the tag detector {self} could not start: {reason}")))
    }
}

impl CornersBy {
    pub(super) fn open<S: Search + 'static>(self, search: S) -> Box<dyn TagDetector> {
        match self {
            CornersBy::Fit => Box::new(WithFittedCorners(search)),
            CornersBy::Library => Box::new(search),
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
        known.ok_or_else(|| {
            StartError(message!(
                "the tag detector '{name}' is not known; use one of {}{}",
                names(TagDetectorChoice::ALL.iter()),
                spelling::hint(name, TagDetectorChoice::ALL.iter().map(|choice| choice.name()))
            ))
        })
    }
}

fn names<'a>(choices: impl Iterator<Item = &'a TagDetectorChoice>) -> String {
    choices.map(|choice| choice.name()).collect::<Vec<_>>().join(", ")
}
