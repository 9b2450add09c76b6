//! Tag detectors: photo in, tag corners out. And the other way: what a tag or marker looks like.

mod apriltag_c;
mod aruco_markers;
mod border;
mod modules;
mod tag_image;

use image::GrayImage;

use crate::scene::TagFamily;

pub use apriltag_c::{AprilTagC, StartError};
pub use aruco_markers::{DictionaryError, MarkerDictionary};
pub use modules::Modules;
pub use tag_image::TagImage;

/// One tag found in a photo.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenTag {
    pub id: u32,
    pub family: TagFamily,
    /// Pixel corners (x, y) of the upright tag: top-left, top-right, bottom-right, bottom-left. Pixel (0, 0) is the centre of
    /// the top-left pixel.
    pub corners_px: [[f64; 2]; 4],
    /// False when part of the tag's border is covered or outside the picture: a corner may then be many pixels off.
    pub is_whole: bool,
}

/// Anything that finds tags in a photo.
pub trait TagDetector {
    /// Every tag of the detector's families, in any order.
    fn find(&mut self, grey: &GrayImage) -> Vec<SeenTag>;
}
