//! What a library makes of a picture: tags with corners of its own.

use image::GrayImage;

use super::SeenTag;
use crate::scene::TagFamily;

/// A tag as a library found it, before its sides were fitted and its border was looked at.
pub(super) struct Found {
    pub family: TagFamily,
    pub id: u32,
    /// In this project's order and pixel convention.
    pub corners_px: [[f64; 2]; 4],
}

impl Found {
    /// The tag with the corners that were found.
    pub fn seen(&self, grey: &GrayImage) -> SeenTag {
        SeenTag::new(self.family, self.id, self.corners_px, grey)
    }
}

/// A library that finds tags.
pub(super) trait Search {
    /// Every tag of the library's families, in any order.
    fn search(&mut self, grey: &GrayImage) -> Vec<Found>;
}
