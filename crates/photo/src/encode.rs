//! Encoding of pictures as JPEG and PNG.

use std::io::Cursor;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, RgbImage, imageops};
use jpeg_encoder::ChromaSubsamplingMethod;

use super::budget::Budget;
use super::photo::Photo;

/// Encodes a picture as JPEG for display; `None` if it is wider or higher than 65,535 px, or empty.
pub fn preview_jpeg(picture: &RgbImage, quality: u8) -> Option<Vec<u8>> {
    jpeg(picture, quality, None, ChromaSubsamplingMethod::Nearest)
}

/// Encodes an upright picture as a camera's JPEG whose sensor image is turned clockwise by 0, 90, 180 or 270°: stores the sensor's image, with EXIF
/// that turns it. `None` if it is wider or higher than 65,535 px, or empty.
pub fn sensor_jpeg(upright: &RgbImage, turned_deg: u32, quality: u8) -> Option<Vec<u8>> {
    match turned_back(upright, turned_deg) {
        None => jpeg(upright, quality, None, ChromaSubsamplingMethod::Nearest),
        Some((sensor, exif)) => jpeg(&sensor, quality, Some(&exif), ChromaSubsamplingMethod::Nearest),
    }
}

/// Encodes a PNG as [`sensor_jpeg`] does JPEGs; `None` for an empty picture.
pub fn sensor_png(upright: &RgbImage, turned_deg: u32) -> Option<Vec<u8>> {
    let (sensor, exif) = turned_back(upright, turned_deg).unzip();
    let picture = sensor.as_ref().unwrap_or(upright);
    let mut png = Vec::new();
    let mut encoder = PngEncoder::new(Cursor::new(&mut png));
    if let Some(exif) = exif {
        encoder.set_exif_metadata(exif).ok()?;
    }
    let (width, height) = picture.dimensions();
    let written = encoder.write_image(picture.as_raw(), width, height, ExtendedColorType::Rgb8);
    written.ok().map(|()| png)
}

/// Returns the sensor's image of an upright one, and the EXIF block (a TIFF structure with only the tag Orientation, Exif 2.32, 4.6.4) that turns it
/// back; `None` if nothing is turned.
fn turned_back(upright: &RgbImage, turned_deg: u32) -> Option<(RgbImage, Vec<u8>)> {
    let (sensor, orientation) = match turned_deg {
        90 => (imageops::rotate270(upright), 6),
        180 => (imageops::rotate180(upright), 3),
        270 => (imageops::rotate90(upright), 8),
        _ => return None,
    };
    let mut exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0, 0]);
    Some((sensor, exif))
}

fn jpeg(picture: &RgbImage, quality: u8, exif: Option<&[u8]>, chroma: ChromaSubsamplingMethod) -> Option<Vec<u8>> {
    let [width, height] = [picture.width(), picture.height()].map(u16::try_from);
    let mut jpeg = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut jpeg, quality);
    encoder.set_chroma_subsampling_method(chroma);
    if let Some(exif) = exif {
        encoder.add_exif_metadata(exif).ok()?;
    }
    let encoded = encoder.encode(
        picture.as_raw(),
        width.ok()?,
        height.ok()?,
        jpeg_encoder::ColorType::Rgb,
    );
    encoded.ok().map(|()| jpeg)
}

/// Encodes and decodes the picture as JPEG of a quality, 1 to 100, as libjpeg writes it: chroma of 2 × 2 pixels is averaged below 90; `None` if it
/// cannot be encoded.
pub fn as_jpeg(picture: &RgbImage, quality: u8) -> Option<RgbImage> {
    let jpeg = jpeg(picture, quality, None, ChromaSubsamplingMethod::Average)?;
    let photo = Photo::from_bytes(Path::new("picture"), jpeg, Budget::FILE).ok()?;
    photo.rgb(1).ok()
}
