//! Tag detection, from photo to tag corners, and the images of tags and markers.

mod appearance;
mod apriltag_c;
mod blur;
pub mod border;
mod cascade;
mod choice;
mod edge;
mod expected;
mod fit;
mod homography;
pub mod inset;
mod legibility;
mod likeness;
mod merge;
mod modules;
mod part;
mod refine;
#[cfg(feature = "full")]
mod rivals;
#[cfg(not(feature = "full"))]
#[path = "no_rivals.rs"]
mod rivals;
mod search;
mod tag_image;

use image::GrayImage;
use serde::{Deserialize, Serialize};

use crate::scene::TagFamily;
use scaleproof_core::geometry::distance;
use scaleproof_photo::Luma;

pub use appearance::{Appearance, edge_blurs, paper_levels};
pub use apriltag_c::AprilTagC;
pub use blur::{EdgeBlur, HOPELESS_BLUR_PX, limit_scale, sharpest_edges_px, worst_px as worst_blur_px};
pub use cascade::{Cascade, CoarseToFine};
pub use choice::{CornersBy, StartError, TagDetectorChoice};
pub use expected::{ExpectedTag, StillMissing};
pub use homography::TagHomography;
pub use modules::Modules;
pub use rivals::*;
pub use search::{enlarged, least_reduction, library_reduction};
pub use tag_image::TagImage;

/// Tag found in a photo.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeenTag {
    /// Number of the tag in its family.
    pub id: u32,
    /// Family of the tag.
    pub family: TagFamily,
    /// Pixel corners (x, y) of the upright tag: top-left, top-right, bottom-right, bottom-left. Pixel (0, 0) is the centre of
    /// the top-left pixel.
    pub corners_px: [[f64; 2]; 4],
    /// True unless part of the tag's border is covered or outside the image: a corner may then be many pixels off.
    pub is_whole: bool,
    /// True unless the corners are those of the library that found the tag, since its sides could not be fitted.
    pub is_fitted: bool,
    /// Blur of its sides, from each corner to the next: standard deviations, px. `None` if they were not fitted.
    #[serde(skip)]
    pub side_blurs_px: Option<[f64; 4]>,
}

impl SeenTag {
    /// Creates a tag with its library's corners in this project's order and pixel convention; tests its border in the photo.
    fn new(family: TagFamily, id: u32, corners_px: [[f64; 2]; 4], grey: &GrayImage) -> SeenTag {
        let is_whole = border::is_whole(grey, &corners_px, family.cells_across());
        SeenTag {
            id,
            family,
            corners_px,
            is_whole,
            is_fitted: false,
            side_blurs_px: None,
        }
    }
}

/// Detector that finds tags in a photo.
pub trait TagDetector {
    /// Returns every tag of the detector's families, in any order.
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag>;

    /// Like [`TagDetector::find`], but asks `missing` which tags are left to find: a detector that could search longer stops if nothing is missing,
    /// and searches at the predicted positions.
    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        let _ = missing;
        self.find(luma)
    }
}

impl TagDetector for Box<dyn TagDetector> {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        (**self).find(luma)
    }

    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        (**self).find_until(luma, missing)
    }
}

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

/// Returns the lengths of the four sides between corners, px: the first from the first corner to the second.
pub fn sides_px(corners_px: &[[f64; 2]; 4]) -> [f64; 4] {
    std::array::from_fn(|i| distance(corners_px[i], corners_px[(i + 1) % 4]))
}

/// Returns the mean of a tag's corners, px.
pub fn middle_px(corners_px: &[[f64; 2]; 4]) -> [f64; 2] {
    [0, 1].map(|k| corners_px.iter().map(|px| px[k]).sum::<f64>() / 4.0)
}

fn shortest_side_px(corners_px: &[[f64; 2]; 4]) -> f64 {
    sides_px(corners_px).into_iter().fold(f64::INFINITY, f64::min)
}
