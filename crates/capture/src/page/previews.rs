//! Small images for the page: the newest frame, and the photos that were taken.

use std::path::Path;

use image::RgbImage;

use crate::Original;
use scaleproof_photo::{Budget, Photo, fitting, preview_jpeg, shrunk};

/// Encodes a frame reduced to a longest side of `longest_side_px`, never enlarged; `None` if it cannot be read.
pub(super) fn of_frame(original: &Original, longest_side_px: u32) -> Option<Vec<u8>> {
    match original {
        Original::Unreadable(_) => None,
        Original::Pixels(rgb) => jpeg(rgb, fitting([rgb.width(), rgb.height()], longest_side_px)),
        Original::Encoded(bytes) => {
            let file = Photo::from_bytes(Path::new("frame"), bytes.clone(), Budget::UPLOAD).ok()?;
            of_file(&file, longest_side_px)
        }
    }
}

/// Encodes a photo on disk reduced to a longest side of `longest_side_px`, never enlarged; `None` if it cannot be read or takes too much memory.
pub(super) fn of_photo(path: &Path, longest_side_px: u32) -> Option<Vec<u8>> {
    of_file(&Photo::open(path).ok()?, longest_side_px)
}

fn of_file(file: &Photo, longest_side_px: u32) -> Option<Vec<u8>> {
    let size = fitting([file.width, file.height], longest_side_px);
    let reduction = file.reduction(size);
    if file.memory(reduction) > Budget::PREVIEW_MEMORY {
        return None;
    }
    jpeg(&file.rgb(reduction).ok()?, size)
}

fn jpeg(image: &RgbImage, size: [u32; 2]) -> Option<Vec<u8>> {
    preview_jpeg(&shrunk(image, size), 75)
}
