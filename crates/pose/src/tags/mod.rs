//! Tag detectors: photo in, tag corners out. And the other way: what a tag or marker looks like.

mod appearance;
mod apriltag_c;
#[cfg(feature = "full")]
mod aruco;
#[cfg(feature = "full")]
mod aruco_markers;
mod border;
mod cascade;
mod choice;
mod coarse_to_fine;
mod edge;
mod expected;
mod fit;
mod homography;
mod inset;
mod likeness;
#[cfg(feature = "full")]
mod locus;
mod merge;
mod modules;
#[cfg(feature = "full")]
mod opencv_markers;
mod part;
mod refine;
mod rivals;
mod search;
mod start;
mod tag_image;

use image::GrayImage;
use serde::{Deserialize, Serialize};

use crate::scene::TagFamily;
use homography::TagHomography;
use scaleproof_photo::photo::Luma;

pub use appearance::{Appearance, paper_levels};
pub use apriltag_c::AprilTagC;
#[cfg(feature = "full")]
pub use aruco::ArucoOpenCv;
#[cfg(feature = "full")]
pub use aruco_markers::{DictionaryError, MarkerDictionary, marker_search};
pub use cascade::Cascade;
pub use choice::ArucoRefiner;
pub use choice::{CornersBy, StartError, TagDetectorChoice};
pub use coarse_to_fine::CoarseToFine;
pub use expected::{ExpectedTag, StillMissing};
#[cfg(feature = "full")]
pub use locus::Locus;
pub use modules::Modules;
#[cfg(feature = "full")]
pub use opencv_markers::{MarkerSearch, SeenMarker};
pub use search::{enlarged, least_reduction};
pub use tag_image::TagImage;

/// One tag found in a photo.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeenTag {
    /// Its number in the family.
    pub id: u32,
    /// Which code it is of.
    pub family: TagFamily,
    /// Pixel corners (x, y) of the upright tag: top-left, top-right, bottom-right, bottom-left. Pixel (0, 0) is the centre of
    /// the top-left pixel.
    pub corners_px: [[f64; 2]; 4],
    /// False when part of the tag's border is covered or outside the image: a corner may then be many pixels off.
    pub is_whole: bool,
}

impl SeenTag {
    /// A tag with its corners in this project's order and pixel convention; its border is looked at in the photo.
    fn new(family: TagFamily, id: u32, corners_px: [[f64; 2]; 4], grey: &GrayImage) -> SeenTag {
        SeenTag {
            id,
            family,
            corners_px,
            is_whole: border::is_whole(grey, &corners_px, cells_across(family)),
        }
    }
}

/// Anything that finds tags in a photo.
pub trait TagDetector {
    /// Every tag of the detector's families, in any order.
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag>;

    /// Like [`TagDetector::find`], but asks `missing` what the tags so far leave to find: a detector that could search longer stops where nothing is
    /// missing, and looks where tags should be.
    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        let _ = missing;
        self.find(luma)
    }
}

impl<D: TagDetector + ?Sized> TagDetector for Box<D> {
    fn find(&mut self, luma: &dyn Luma) -> Vec<SeenTag> {
        (**self).find(luma)
    }

    fn find_until(&mut self, luma: &dyn Luma, missing: &mut dyn FnMut(&[SeenTag]) -> StillMissing) -> Vec<SeenTag> {
        (**self).find_until(luma, missing)
    }
}

/// Width of the outline the corners lie on, in bit cells (`width_at_border` of the C library).
pub fn cells_across(family: TagFamily) -> f64 {
    match family {
        TagFamily::Tag16h5 => 6.0,
        TagFamily::Tag25h9 => 7.0,
        TagFamily::Tag36h11 => 8.0,
        TagFamily::TagStandard41h12 => 5.0,
        TagFamily::TagStandard52h13 => 6.0,
    }
}
