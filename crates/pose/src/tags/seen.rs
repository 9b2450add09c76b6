//! Tags found in a photo.

use image::GrayImage;
use serde::{Deserialize, Serialize};

use super::border;
use crate::scene::TagFamily;
use scaleproof_core::geometry::distance;

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
    pub(super) fn new(family: TagFamily, id: u32, corners_px: [[f64; 2]; 4], grey: &GrayImage) -> SeenTag {
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

/// Returns the lengths of the four sides between corners, px: the first from the first corner to the second.
pub fn sides_px(corners_px: &[[f64; 2]; 4]) -> [f64; 4] {
    std::array::from_fn(|i| distance(corners_px[i], corners_px[(i + 1) % 4]))
}

/// Returns the mean of a tag's corners, px.
pub fn middle_px(corners_px: &[[f64; 2]; 4]) -> [f64; 2] {
    [0, 1].map(|k| corners_px.iter().map(|px| px[k]).sum::<f64>() / 4.0)
}

/// Returns the length of the shortest side between corners, px.
pub(super) fn shortest_side_px(corners_px: &[[f64; 2]; 4]) -> f64 {
    sides_px(corners_px).into_iter().fold(f64::INFINITY, f64::min)
}
