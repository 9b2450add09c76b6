//! `detectors check --save`: copies of the photos with what was found drawn in.

use std::path::{Path, PathBuf};

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;

use crate::cli::copies::{self, CopiesError};
use scaleproof_core::geometry::BoxPx;
use scaleproof_photo::draw::{self, LabelAnchor, Lettering, Pen};

const JPEG_QUALITY: u8 = 90;

/// Colours of the detectors, in their order; told apart by the colour-blind (Okabe & Ito 2008).
const COLOURS: [[u8; 3]; 6] = [
    [230, 159, 0],
    [86, 180, 233],
    [0, 158, 115],
    [240, 228, 66],
    [213, 94, 0],
    [204, 121, 167],
];

/// The colour of the detector with this number.
pub(super) fn colour(detector: usize) -> [u8; 3] {
    COLOURS[detector % COLOURS.len()]
}

/// Draws a box and what it is called.
pub(super) fn draw_box(image: &mut RgbImage, box_px: BoxPx, text: &str, colour: [u8; 3]) {
    let (width_px, size_px) = draw::readable_px(image);
    // A box counts from the image's edge, a drawing from the middle of its first pixel.
    let [left, top, right, bottom] = [box_px.x1, box_px.y1, box_px.x2, box_px.y2].map(|v| v - 0.5);
    draw::rectangle(image, [left, top], [right, bottom], Pen { colour, width_px });
    let lettering = Lettering {
        colour: [0; 3],
        ground: colour,
        size_px,
    };
    draw::label(image, [left, top], LabelAnchor::BottomLeft, text, lettering);
}

/// An image as the bytes of a JPEG file.
pub(super) fn jpeg(image: &RgbImage) -> image::ImageResult<Vec<u8>> {
    let mut bytes = Vec::new();
    image.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY))?;
    Ok(copies::marked(&bytes))
}

/// Where the copy of each photo goes: named as the photo is, numbered where two have the same name.
///
/// # Errors
/// A folder that holds one of the photos, or a file of such a name that no run has drawn.
pub(super) fn places(folder: &Path, photos: &[PathBuf]) -> Result<Vec<PathBuf>, CopiesError> {
    copies::places(folder, photos, "--save", |stem, number| match number {
        1 => format!("{stem}_detections.jpg"),
        number => format!("{stem}_detections_{number}.jpg"),
    })
}
