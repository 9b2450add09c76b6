//! The images of frames: PNG in, PNG out.

use std::fmt::Display;
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ColorType, DynamicImage, ExtendedColorType, GrayImage, ImageDecoder, ImageEncoder, ImageFormat, RgbImage};

use crate::{FramesError, Positions, of_file};
use scaleproof_core::files;
use scaleproof_core::message::{Message, ensure, message};
use scaleproof_photo::{Budget, open_png};

/// Image of the share of each pixel that something covers; 255 is all of it.
pub type Coverage = GrayImage;

/// Encodes an 8-bit RGB image as PNG.
pub fn encode_rgb(image: &RgbImage) -> Result<Vec<u8>, FramesError> {
    png(image.as_raw(), image.dimensions().into(), ExtendedColorType::Rgb8)
}

/// Encodes an 8-bit grey image as PNG.
pub fn encode_grey(image: &GrayImage) -> Result<Vec<u8>, FramesError> {
    png(image.as_raw(), image.dimensions().into(), ExtendedColorType::L8)
}

/// Reduces an image in linear light by the mean of each square of `factor`² pixels, as a camera with fewer pixels sees it. Pixels at the right and
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

/// Encodes linear light (RGB, 1 is white, row by row) as 16-bit PNG, in which 65535 stands for `linear_max`.
pub fn encode_linear(linear: &[[f32; 3]], size_px: [u32; 2], linear_max: f64) -> Result<Vec<u8>, FramesError> {
    let level = |v: f32| (f64::from(v) / linear_max * 65535.0).round().clamp(0.0, 65535.0) as u16;
    wide(linear.iter().flatten().map(|v| level(*v)), size_px)
}

/// Encodes points of the paint (x, y, z in mm, row by row) as 16-bit PNG, in which 0 and 65535 stand for `low_mm` and `high_mm` of `about`.
pub fn encode_positions(
    positions: impl Iterator<Item = [f64; 3]>,
    size_px: [u32; 2],
    about: &Positions,
) -> Result<Vec<u8>, FramesError> {
    let (low, high) = (about.low_mm, about.high_mm);
    let level = move |p: [f64; 3]| {
        std::array::from_fn::<u16, 3, _>(|i| {
            let share = (p[i] - low[i]) / (high[i] - low[i]);
            (65535.0 * share).round().clamp(0.0, 65535.0) as u16
        })
    };
    wide(positions.flat_map(level), size_px)
}

/// Encodes levels of 16 bits as an RGB image.
fn wide(levels: impl Iterator<Item = u16>, size_px: [u32; 2]) -> Result<Vec<u8>, FramesError> {
    let bytes: Vec<u8> = levels.flat_map(u16::to_ne_bytes).collect();
    png(&bytes, size_px, ExtendedColorType::Rgb16)
}

fn png(bytes: &[u8], [width, height]: [u32; 2], kind: ExtendedColorType) -> Result<Vec<u8>, FramesError> {
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Best, FilterType::Adaptive)
        .write_image(bytes, width, height, kind)
        .map_err(FramesError::encode)?;
    Ok(file)
}

/// Reads a PNG of exactly this size and kind, which errors call `key`.
pub(super) fn read_png(
    path: &Path,
    key: &str,
    size_px: [u32; 2],
    kind: ColorType,
) -> Result<DynamicImage, FramesError> {
    decode(&files::read(path)?, key, size_px, kind).map_err(of_file(path))
}

fn decode(bytes: &[u8], key: &str, size_px: [u32; 2], kind: ColorType) -> Result<DynamicImage, Message> {
    let damaged = |e: &dyn Display| message!("the PNG cannot be decoded ({e}): make the frame again");
    let is_png = image::guess_format(bytes).ok() == Some(ImageFormat::Png);
    ensure!(is_png, "the {key} is no PNG: make the frame again");
    let decoder = open_png(bytes, &Budget::FILE).map_err(|e| damaged(&e))?;
    // The size stands in the header: a huge image is refused before its pixels take memory.
    let ([width, height], [across, down]) = (<[u32; 2]>::from(decoder.dimensions()), size_px);
    ensure!(
        [width, height] == size_px,
        "the {key} has {width}×{height} pixels and must have {across}×{down}, as frames.json says: make the frame again"
    );
    let name = match kind {
        ColorType::Rgb8 => "8-bit RGB without transparency",
        ColorType::L8 => "8-bit grey",
        _ => "16-bit RGB",
    };
    ensure!(decoder.color_type() == kind, "the {key} must be {name}: save it so");
    DynamicImage::from_decoder(decoder).map_err(|e| damaged(&e))
}
