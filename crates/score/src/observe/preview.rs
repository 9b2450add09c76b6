//! Small JPEGs of the photos for the report.

use crate::observe::DecodedPhoto;
use scaleproof_photo::{PhotoError, fitting, preview_jpeg, shrunk};

/// Largest number of previews: more make a page that no browser shows, and a run that no memory holds.
const MAX_PREVIEWS: usize = 1000;

/// Returns the longest side in px of the previews of `photos` photos: the fewer, the larger.
pub(crate) fn longest_side_px(photos: usize) -> u32 {
    match photos {
        0..=32 => 1200,
        33..=200 => 640,
        _ => 320,
    }
}

/// Returns true if the photo of this id (from 1) has a preview in a run of `photos` photos: all have one, or a thousand spread evenly.
pub fn has_preview(id: u64, photos: usize) -> bool {
    let share = |id: u64| id as u128 * MAX_PREVIEWS as u128 / photos as u128;
    photos <= MAX_PREVIEWS || share(id) != share(id - 1)
}

/// Least size of a photo reduced as it is decoded, as a share of the preview's: resizing a larger one would cost more than its decoding.
const NEARLY: f64 = 0.75;

/// Returns the JPEG of a photo with its longest side at most `longest_side_px` and at least [`NEARLY`] of that; never larger than the photo, and
/// empty where it cannot be encoded.
pub(crate) fn jpeg(decoded: &mut DecodedPhoto, longest_side_px: u32) -> Result<Vec<u8>, PhotoError> {
    let size = fitting([decoded.file.width, decoded.file.height], longest_side_px);
    let image = decoded.at_least(size.map(|side| (NEARLY * f64::from(side)).ceil() as u32))?;
    let is_small = image.width() <= size[0] && image.height() <= size[1];
    // Without a preview the report still has its numbers.
    let jpeg = match is_small {
        true => preview_jpeg(image, 80),
        false => preview_jpeg(&shrunk(image, size), 80),
    };
    Ok(jpeg.unwrap_or_default())
}
