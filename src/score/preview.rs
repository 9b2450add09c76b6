//! Small JPEGs of the photos for the report: the fewer photos, the larger.

use image::codecs::jpeg::JpegEncoder;
use image::imageops::{self, FilterType};

use crate::photo::Photo;

/// Longest side in pixels of the previews of so many photos: some megabytes for all of them together.
pub(super) fn longest_side_px(photos: usize) -> u32 {
    match photos {
        0..=32 => 1200,
        33..=200 => 640,
        _ => 320,
    }
}

/// The photo with its longest side scaled down to `longest_side_px`; never larger than it is.
pub(super) fn jpeg(photo: &Photo, longest_side_px: u32) -> Vec<u8> {
    let (width, height) = (f64::from(photo.width()), f64::from(photo.height()));
    let scale = (f64::from(longest_side_px) / width.max(height)).min(1.0);
    let [width, height] = [width, height].map(|side| (side * scale).round().max(1.0) as u32);
    let small = imageops::resize(&photo.rgb, width, height, FilterType::Triangle);
    let mut jpeg = Vec::new();
    // Encoding into memory fails for no picture of this size; without a preview the report still has its numbers.
    match JpegEncoder::new_with_quality(&mut jpeg, 80).encode_image(&small) {
        Ok(()) => jpeg,
        Err(_) => Vec::new(),
    }
}
