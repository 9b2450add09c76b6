//! Tag detectors that need OpenCV and locus-core (feature `full`), for comparison and as stages of the cascade.

mod aruco;
mod locus;
mod markers;

use image::GrayImage;

use super::fit::WithFittedCorners;
use super::search::{Found, Search, Strength};
use super::{CornersBy, StartError, TagDetector, TagDetectorChoice};
use crate::scene::TagFamily;
use aruco::ArucoOpenCv;
use locus::Locus;
use scaleproof_photo::doubled;

pub use markers::{DictionaryError, MarkerDictionary, MarkerSearch, SeenMarker, marker_search};

/// Returns the version of OpenCV at run time.
pub fn opencv_version() -> Option<String> {
    opencv::core::get_version_string().ok()
}

/// Returns names and versions of the cascade's detectors before C AprilTag, for a result's provenance.
pub(super) fn libraries() -> String {
    let opencv = opencv_version().unwrap_or_default();
    format!("locus-core {}, OpenCV {opencv}, ", Locus::VERSION)
}

/// Returns the cascade's finders of this strength, the fastest first.
pub(super) fn finders(strength: Strength, families: &[TagFamily]) -> Result<Vec<Box<dyn Search>>, StartError> {
    let mut finders: Vec<Box<dyn Search>> = Vec::new();
    if let (Some(read), Strength::Speed | Strength::Noise) = (read_by(LOCUS, families), strength) {
        let is_for_noise = strength == Strength::Noise;
        let start = if is_for_noise {
            Locus::for_noise
        } else {
            Locus::unrefined
        };
        finders.push(Box::new(start(&read)?));
    }
    if let (Some(read), Strength::Speed | Strength::SmallTags) = (read_by(ARUCO, families), strength) {
        let aruco = ArucoOpenCv::new(&read, CornersBy::Fit)?;
        finders.push(match strength {
            Strength::SmallTags => Box::new(Enlarged(aruco)),
            _ => Box::new(aruco),
        });
    }
    Ok(finders)
}

const LOCUS: TagDetectorChoice = TagDetectorChoice::Locus;
const ARUCO: TagDetectorChoice = TagDetectorChoice::Aruco(CornersBy::Fit);

/// Returns the families that a detector reads; `None` if there are none.
fn read_by(detector: TagDetectorChoice, families: &[TagFamily]) -> Option<Vec<TagFamily>> {
    let read: Vec<TagFamily> = families.iter().copied().filter(|f| detector.reads(*f)).collect();
    (!read.is_empty()).then_some(read)
}

/// Starts a detector of OpenCV or locus-core.
pub(super) fn open(detector: TagDetectorChoice, families: &[TagFamily]) -> Result<Box<dyn TagDetector>, StartError> {
    Ok(match detector {
        TagDetectorChoice::Aruco(by) => by.open(ArucoOpenCv::new(families, by)?),
        _ => Box::new(WithFittedCorners(Locus::new(families)?)),
    })
}

/// Search of the image at twice its size.
struct Enlarged<S>(S);

impl<S: Search> Search for Enlarged<S> {
    fn search_all(&mut self, grey: &GrayImage) -> Vec<Found> {
        let mut found = self.0.search(&doubled(grey));
        for tag in &mut found {
            tag.corners_px = tag.corners_px.map(|c| c.map(|v| (v + 0.5) / 2.0 - 0.5)); // as in `enlarged`
        }
        found
    }
}
