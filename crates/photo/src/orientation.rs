//! Turns between the sensor's image and the upright one.

use image::metadata::Orientation;
use image::{GrayImage, imageops};

/// Returns true if an orientation swaps width and height.
pub(super) fn lies_across(orientation: Orientation) -> bool {
    turned_deg(orientation) % 180 == 90
}

/// Returns the clockwise rotation that makes the sensor's image upright, degrees; mirroring, done by software before, is ignored.
pub(super) fn turned_deg(orientation: Orientation) -> u32 {
    match orientation {
        Orientation::NoTransforms | Orientation::FlipHorizontal => 0,
        Orientation::Rotate90 | Orientation::Rotate270FlipH => 90,
        Orientation::Rotate180 | Orientation::FlipVertical => 180,
        Orientation::Rotate270 | Orientation::Rotate90FlipH => 270,
    }
}

/// Rotates an upright picture back to the sensor's orientation, which was turned clockwise by 0, 90, 180 or 270°.
pub fn turned_to_sensor(upright: GrayImage, turned_deg: u32) -> GrayImage {
    match turned_deg {
        90 => imageops::rotate270(&upright),
        180 => imageops::rotate180(&upright),
        270 => imageops::rotate90(&upright),
        _ => upright,
    }
}
