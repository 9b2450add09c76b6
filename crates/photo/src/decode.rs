//! Decoding of the bytes of a JPEG or PNG file to upright pixels, completely or not at all.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, RgbImage};

use super::budget::{Budget, DecodeCost};
use super::error::DecodeProblem;
use super::exif_tags;
use super::jpeg::{Coefficients, Colours, Frame, JpegError};
use super::orientation::lies_across;

/// Returns the kind of an HEIF file (ISO 23008-12, 10: its brands), by its initial `ftyp` box.
pub(super) fn heif_kind(bytes: &[u8]) -> Option<&'static str> {
    let length = u32::from_be_bytes(*bytes.first_chunk()?) as usize;
    let ftyp = bytes.get(4..length.min(bytes.len()).min(LONGEST_FTYP))?;
    // The major brand, a version, and the compatible brands.
    let (major, others) = ftyp.strip_prefix(b"ftyp")?.split_at_checked(4)?;
    let brands: Vec<&[u8]> = std::iter::once(major).chain(others.chunks_exact(4).skip(1)).collect();
    let is_any = |known: &[&[u8]]| brands.iter().any(|brand| known.contains(brand));
    if is_any(&[b"avif", b"avis"]) {
        Some("AVIF")
    } else if is_any(&[b"heic", b"heix", b"hevc", b"hevx", b"heim", b"heis"]) {
        Some("HEIC")
    } else {
        is_any(&[b"mif1", b"msf1"]).then_some("HEIF")
    }
}

/// Maximum length of an `ftyp` box, bytes: files name a handful of brands, 4 bytes each.
const LONGEST_FTYP: usize = 1024;

#[derive(Debug)]
pub(super) struct Header {
    size: [u32; 2],
    pub cost: DecodeCost,
    pub orientation: Orientation,
    pub exif: Option<Vec<u8>>,
    /// Header of a JPEG; `None` for a PNG.
    jpeg: Option<Frame>,
}

impl Header {
    /// Reads a header within a budget; returns an error for a truncated JPEG.
    pub(super) fn read(bytes: &[u8], budget: &Budget) -> Result<Header, DecodeProblem> {
        let (size, cost, exif, jpeg) = match image::guess_format(bytes) {
            Ok(ImageFormat::Jpeg) => {
                budget.check_bytes(bytes.len())?;
                let mut frame = Frame::read(bytes).map_err(|e| jpeg_problem(e, budget))?;
                let (size, scans, components) = (frame.size, frame.scans, frame.components.len() as u64);
                let cost = DecodeCost::of_jpeg(size, components, scans, frame.is_progressive, bytes.len());
                budget.check(&cost)?;
                (size, cost, frame.exif.take(), Some(frame))
            }
            Ok(ImageFormat::Png) => {
                let (decoder, cost, exif) = png_header(bytes, budget)?;
                (decoder.dimensions().into(), cost, exif, None)
            }
            _ => return Err(heif_kind(bytes).map_or(DecodeProblem::NotAnImage, DecodeProblem::Heif)),
        };
        Ok(Header {
            size,
            cost,
            orientation: exif_tags::orientation(exif.as_deref()),
            exif,
            jpeg,
        })
    }

    /// Returns true for a JPEG without an end-of-image marker.
    pub(super) fn lacks_end(&self) -> bool {
        self.jpeg.as_ref().is_some_and(|frame| frame.lacks_end)
    }

    /// Returns the colour space of a JPEG; `None` for a PNG.
    pub(super) fn colours(&self) -> Option<Colours> {
        self.jpeg.as_ref().map(|frame| frame.colours)
    }

    /// Returns true for a JPEG that stores luma separately, as almost all do: the others are CMYK or plain RGB.
    pub(super) fn has_luma(&self) -> bool {
        matches!(self.colours(), Some(Colours::YCbCr | Colours::Grey))
    }

    pub(super) fn upright_size(&self) -> [u32; 2] {
        let [width, height] = self.size;
        let is_across = lies_across(self.orientation);
        if is_across { [height, width] } else { [width, height] }
    }

    /// Reads the coefficients of a JPEG, from which pixels of every size follow; `None` for a PNG.
    pub(super) fn coefficients(&self, bytes: &[u8], budget: &Budget) -> Result<Option<Coefficients>, DecodeProblem> {
        let Some(frame) = &self.jpeg else { return Ok(None) };
        let most_bytes = budget.memory.saturating_sub(self.cost.pixel_bytes());
        let read = Coefficients::read(bytes, frame, most_bytes);
        read.map(Some).map_err(|e| jpeg_problem(e, budget))
    }

    pub(super) fn png(&self, bytes: &[u8], budget: &Budget) -> Result<RgbImage, DecodeProblem> {
        let (decoder, ..) = png_header(bytes, budget)?;
        let stored = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb8();
        let mut upright = DynamicImage::from(stored);
        upright.apply_orientation(self.orientation);
        Ok(upright.into_rgb8())
    }
}

fn jpeg_problem(e: JpegError, budget: &Budget) -> DecodeProblem {
    match e {
        JpegError::Truncated => DecodeProblem::Truncated,
        JpegError::Damaged(reason) => DecodeProblem::Damaged(reason.to_owned()),
        JpegError::TooManyValues => DecodeProblem::TooLarge(format!(
            "data that takes more than {} MB to decode",
            budget.memory >> 20
        )),
    }
}

/// Opens a PNG whose header is within the budget; the caller decides about size and kind before it decodes.
pub fn open_png<'a>(bytes: &'a [u8], budget: &Budget) -> Result<impl ImageDecoder + 'a, DecodeProblem> {
    png_header(bytes, budget).map(|(decoder, ..)| decoder)
}

/// Maximum memory for unpacking colour profiles and texts of a PNG's header, bytes; not for its pixels.
const PNG_CHUNKS: u64 = 64 << 20;

/// Decoder that has read the header, the image's cost, and its EXIF block.
type OpenedPng<'a> = (PngDecoder<Cursor<&'a [u8]>>, DecodeCost, Option<Vec<u8>>);

fn png_header<'a>(bytes: &'a [u8], budget: &Budget) -> Result<OpenedPng<'a>, DecodeProblem> {
    budget.check_bytes(bytes.len())?;
    if !has_whole_colours(bytes) {
        return Err(DecodeProblem::Damaged("its palette ends within a colour".to_owned()));
    }
    // Checked before the decoder, whose message for sizes beyond its own limits does not state them.
    if let Some(size) = png_size(bytes) {
        budget.check(&DecodeCost::of_png(size, 1, false))?;
    }
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(PNG_CHUNKS);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?;
    let exif = decoder.exif_metadata().ok().flatten();
    let is_turned = lies_across(exif_tags::orientation(exif.as_deref()));
    let bytes_per_pixel = decoder.color_type().bytes_per_pixel().into();
    let cost = DecodeCost::of_png(decoder.dimensions().into(), bytes_per_pixel, is_turned);
    budget.check(&cost)?;
    Ok((decoder, cost, exif))
}

/// Returns width and height of a PNG, px, from its first chunk (ISO/IEC 15948, 11.2.1).
fn png_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let header = bytes.get(12..24)?.strip_prefix(b"IHDR")?;
    let (width, height) = header.split_first_chunk::<4>()?;
    Some([*width, *height.first_chunk()?].map(u32::from_be_bytes))
}

/// Returns true if the palette of a PNG, if any, consists of whole colours (ISO/IEC 15948, 11.2.2). The decoder assumes this, and panics otherwise
/// (png 0.18.1, found by fuzzing).
fn has_whole_colours(bytes: &[u8]) -> bool {
    const SIGNATURE: usize = 8;
    /// Length and kind before a chunk's content, and its checksum after it.
    const FRAMING: usize = 12;
    let mut at = SIGNATURE;
    while let Some([length, kind]) = bytes
        .get(at..)
        .and_then(|rest| rest.as_chunks::<4>().0.first_chunk::<2>())
    {
        let length = u32::from_be_bytes(*length) as usize;
        match kind {
            b"PLTE" => return length.is_multiple_of(3),
            b"IDAT" => return true,
            _ => at = at.saturating_add(FRAMING).saturating_add(length),
        }
    }
    true
}

/// Returns a decoder's message up to its first line, without the internals it prints in braces.
fn damaged(e: impl std::fmt::Display) -> DecodeProblem {
    let text = e.to_string();
    let line = text.lines().next().unwrap_or_default();
    let line = line.strip_prefix("Format error decoding Png: ").unwrap_or(line);
    DecodeProblem::Damaged(line.split(" {").next().unwrap_or(line).to_owned())
}
