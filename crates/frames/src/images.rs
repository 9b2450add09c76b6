//! The images of frames: PNG in, PNG out.

use std::fmt::Display;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ColorType, DynamicImage, ExtendedColorType, GrayImage, ImageDecoder, ImageEncoder, ImageFormat, RgbImage};

use super::{FramesError, require};
use scaleproof_core::files::{self, FileError};
use scaleproof_photo::{Budget, open_png};

/// The share of each pixel that something covers, 255 is all of it.
pub type Coverage = GrayImage;

pub fn encode_rgb(image: &RgbImage) -> Result<Vec<u8>, FramesError> {
    png(image.as_raw(), image.dimensions(), ExtendedColorType::Rgb8)
}

pub fn encode_grey(image: &GrayImage) -> Result<Vec<u8>, FramesError> {
    png(image.as_raw(), image.dimensions(), ExtendedColorType::L8)
}

/// The mean of each square of `factor`² pixels of an image in linear light: what a camera with fewer pixels would see. Pixels at the right and
/// lower border that fill no square are left out.
pub(crate) fn reduced(
    mut image: impl ExactSizeIterator<Item = [f32; 3]>,
    width: usize,
    factor: usize,
) -> Vec<[f32; 3]> {
    let (columns, rows) = (width / factor, image.len() / width / factor);
    let mut small = vec![[0.0; 3]; columns * rows];
    let share = 1.0 / (factor * factor) as f32;
    for y in 0..rows * factor {
        let row = &mut small[y / factor * columns..][..columns];
        for (x, pixel) in image.by_ref().take(width).enumerate() {
            if let Some(sum) = row.get_mut(x / factor) {
                (0..3).for_each(|c| sum[c] += share * pixel[c]);
            }
        }
    }
    small
}

/// `linear`: RGB in linear light, 1 is white, row by row.
pub fn encode_linear(linear: &[[f32; 3]], size_px: [u32; 2], linear_max: f64) -> Result<Vec<u8>, FramesError> {
    let level = |v: f32| (f64::from(v) / linear_max * 65535.0).round().clamp(0.0, 65535.0) as u16;
    wide(linear.iter().flatten().map(|v| level(*v)), size_px)
}

/// `positions`: x, y, z in mm, row by row; where there is no paint the value does not matter.
pub fn encode_positions(
    positions: impl Iterator<Item = [f64; 3]>,
    size_px: [u32; 2],
    (low, high): ([f64; 3], [f64; 3]),
) -> Result<Vec<u8>, FramesError> {
    let level = move |p: [f64; 3]| {
        std::array::from_fn::<u16, 3, _>(|i| {
            let share = (p[i] - low[i]) / (high[i] - low[i]);
            (65535.0 * share).round().clamp(0.0, 65535.0) as u16
        })
    };
    wide(positions.flat_map(level), size_px)
}

fn wide(levels: impl Iterator<Item = u16>, [width, height]: [u32; 2]) -> Result<Vec<u8>, FramesError> {
    let bytes: Vec<u8> = levels.flat_map(u16::to_ne_bytes).collect();
    png(&bytes, (width, height), ExtendedColorType::Rgb16)
}

fn png(bytes: &[u8], (width, height): (u32, u32), kind: ExtendedColorType) -> Result<Vec<u8>, FramesError> {
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive)
        .write_image(bytes, width, height, kind)
        .map_err(|e| FramesError::Encode(e.to_string()))?;
    Ok(file)
}

/// Reads a PNG of exactly this size and kind; `key` says in the sentence what it was to be.
pub(super) fn read_png(
    path: &Path,
    key: &str,
    size_px: [u32; 2],
    kind: ColorType,
) -> Result<DynamicImage, FramesError> {
    let content = |message: String| FileError::content(path, message);
    let damaged = |e: &dyn Display| content(format!("the PNG cannot be decoded ({e}): make the frame again"));
    let bytes = files::read(path)?;
    require(image::guess_format(&bytes).ok() == Some(ImageFormat::Png), || {
        content(format!("the {key} is no PNG: make the frame again"))
    })?;
    let decoder = open_png(&bytes, &Budget::FILE).map_err(|e| damaged(&e))?;
    // The size stands in the header: a huge image is refused before its pixels take memory.
    let found = <[u32; 2]>::from(decoder.dimensions());
    require(found == size_px, || {
        content(format!(
            "the {key} has {}×{} pixels and must have {}×{}, as frames.json says: make the frame again",
            found[0], found[1], size_px[0], size_px[1]
        ))
    })?;
    require(decoder.color_type() == kind, || {
        let name = match kind {
            ColorType::Rgb8 => "8-bit RGB without transparency",
            ColorType::L8 => "8-bit grey",
            _ => "16-bit RGB",
        };
        content(format!("the {key} must be {name}: save it so"))
    })?;
    Ok(DynamicImage::from_decoder(decoder).map_err(|e| damaged(&e))?)
}
