//! Photos: decoded upright, or refused with the reason. A file is never written back.

mod file;
mod lens;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageFormat, ImageReader, RgbImage};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use crate::files;

pub use file::PhotoFile;
pub use lens::Lens;

/// A picture beyond this is refused before it is decoded: a few kilobytes of PNG can claim to be terabytes.
const MAX_MEGAPIXELS: u64 = 250;

/// Why a photo could not be used.
#[derive(Debug, thiserror::Error)]
pub enum PhotoError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("{path} is not a JPEG or PNG picture: use a photo straight from the camera", path = path.display())]
    NotAPicture { path: PathBuf },
    #[error("{path} ends in the middle of the picture: copy it from the camera again", path = path.display())]
    Truncated { path: PathBuf },
    #[error("{path} has {megapixels} megapixels, more than the {limit} that fit in memory safely: scale it down", path = path.display(), limit = MAX_MEGAPIXELS)]
    TooLarge { path: PathBuf, megapixels: u64 },
    #[error("{path} cannot be decoded ({reason}): copy it from the camera again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
}

/// One decoded photo, turned upright by its EXIF orientation.
#[derive(Debug, Clone)]
pub struct Photo {
    pub rgb: RgbImage,
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// How far EXIF turned the picture clockwise: 0, 90, 180 or 270. A mirrored picture is mirrored back besides.
    pub turned_deg: u32,
    /// What EXIF says about the lens.
    pub lens: Lens,
}

impl Photo {
    /// Reads and decodes a JPEG or PNG file, whatever its name says.
    pub fn open(path: &Path) -> Result<Photo, PhotoError> {
        let bytes = files::read(path)?;
        let decoded = decode(&bytes).map_err(|problem| problem.at(path))?;
        Ok(Photo {
            rgb: decoded.rgb,
            sha256: files::sha256_hex(&bytes),
            turned_deg: decoded.turned_deg,
            lens: decoded.lens,
        })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.rgb.width()
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.rgb.height()
    }

    /// Brightness, 8 bit, for the tag detectors.
    pub fn grey(&self) -> GrayImage {
        image::imageops::grayscale(&self.rgb)
    }
}

/// What is wrong with the bytes of a picture.
#[derive(Debug, PartialEq)]
enum DecodeProblem {
    NotAPicture,
    Truncated,
    /// Megapixels.
    TooLarge(u64),
    Damaged(String),
}

impl DecodeProblem {
    fn at(self, path: &Path) -> PhotoError {
        let path = path.to_owned();
        match self {
            DecodeProblem::NotAPicture => PhotoError::NotAPicture { path },
            DecodeProblem::Truncated => PhotoError::Truncated { path },
            DecodeProblem::TooLarge(megapixels) => PhotoError::TooLarge { path, megapixels },
            DecodeProblem::Damaged(reason) => PhotoError::Damaged { path, reason },
        }
    }
}

/// A picture, upright, and what its EXIF data says.
#[derive(Debug)]
struct Decoded {
    rgb: RgbImage,
    turned_deg: u32,
    lens: Lens,
}

fn decode(bytes: &[u8]) -> Result<Decoded, DecodeProblem> {
    let (mut picture, exif) = match picture_format(bytes)? {
        ImageFormat::Jpeg => decode_jpeg(bytes)?,
        _ => decode_png(bytes)?,
    };
    let orientation = exif.as_deref().and_then(Orientation::from_exif_chunk);
    let orientation = orientation.unwrap_or(Orientation::NoTransforms);
    picture.apply_orientation(orientation);
    Ok(Decoded {
        rgb: picture.into_rgb8(),
        turned_deg: turned_deg(orientation),
        lens: exif.map(Lens::from_exif).unwrap_or_default(),
    })
}

/// JPEG or PNG, by the first bytes. A cut JPEG ends here.
fn picture_format(bytes: &[u8]) -> Result<ImageFormat, DecodeProblem> {
    match image::guess_format(bytes) {
        // Decoders fill the missing rows of a cut JPEG with grey and call it a success, so we look first.
        Ok(ImageFormat::Jpeg) if !jpeg_is_complete(bytes) => Err(DecodeProblem::Truncated),
        Ok(format @ (ImageFormat::Jpeg | ImageFormat::Png)) => Ok(format),
        _ => Err(DecodeProblem::NotAPicture),
    }
}

/// How far the sensor's picture is turned clockwise; mirroring is what software did to it before.
fn turned_deg(orientation: Orientation) -> u32 {
    match orientation {
        Orientation::NoTransforms | Orientation::FlipHorizontal => 0,
        Orientation::Rotate90 | Orientation::Rotate270FlipH => 90,
        Orientation::Rotate180 | Orientation::FlipVertical => 180,
        Orientation::Rotate270 | Orientation::Rotate90FlipH => 270,
    }
}

/// A picture as it is stored, and its EXIF data.
type Stored = (DynamicImage, Option<Vec<u8>>);

fn decode_png(bytes: &[u8]) -> Result<Stored, DecodeProblem> {
    let mut decoder = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png)
        .into_decoder()
        .map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    // EXIF data that cannot be read is no reason to refuse the picture.
    let exif = decoder.exif_metadata().ok().flatten();
    Ok((DynamicImage::from_decoder(decoder).map_err(damaged)?, exif))
}

fn decode_jpeg(bytes: &[u8]) -> Result<Stored, DecodeProblem> {
    let (pixels, [width, height], exif) = jpeg_pixels(bytes, ColorSpace::RGB)?;
    let picture = RgbImage::from_raw(width, height, pixels).ok_or_else(|| damaged("it is no RGB picture"))?;
    Ok((picture.into(), exif))
}

/// Pixels as they are stored, width and height, EXIF data.
type JpegPixels = (Vec<u8>, [u32; 2], Option<Vec<u8>>);

fn jpeg_pixels(bytes: &[u8], colours: ColorSpace) -> Result<JpegPixels, DecodeProblem> {
    let mut decoder = jpeg_header(bytes, colours)?;
    let (width, height) = decoder.dimensions().ok_or_else(|| damaged("it has no size"))?;
    check_size(width as u64, height as u64)?;
    let pixels = decoder.decode().map_err(damaged)?;
    Ok((pixels, [width as u32, height as u32], decoder.exif().cloned()))
}

/// A decoder that has read the header. Strict: by default it fills what damaged data leaves open with grey.
fn jpeg_header(bytes: &[u8], colours: ColorSpace) -> Result<JpegDecoder<ZCursor<&[u8]>>, DecodeProblem> {
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(colours);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    Ok(decoder)
}

fn check_size(width: u64, height: u64) -> Result<(), DecodeProblem> {
    let megapixels = width * height / 1_000_000;
    if megapixels > MAX_MEGAPIXELS {
        Err(DecodeProblem::TooLarge(megapixels))
    } else {
        Ok(())
    }
}

/// The first line of what a decoder says, without the internals it prints in braces.
fn damaged(e: impl std::fmt::Display) -> DecodeProblem {
    let text = e.to_string();
    let line = text.lines().next().unwrap_or_default();
    DecodeProblem::Damaged(line.split(" {").next().unwrap_or(line).to_owned())
}

/// True when the first picture of a JPEG file reaches its end-of-image marker (ITU-T T.81, annex B).
///
/// Segments are skipped by their length, so the thumbnail inside the EXIF segment cannot be taken for the end; bytes after the
/// end (motion photos, depth maps) do not matter.
pub fn jpeg_is_complete(bytes: &[u8]) -> bool {
    const END_OF_IMAGE: u8 = 0xD9;
    let mut at = 2; // behind the start-of-image marker
    loop {
        let Some(marker_at) = find_marker(bytes, at) else {
            return false;
        };
        let marker = bytes[marker_at + 1];
        at = marker_at + 2;
        match marker {
            END_OF_IMAGE => return true,
            // Markers without a segment: TEM and the restart markers, which also stand inside scan data.
            0x01 | 0xD0..=0xD7 => {}
            _ => {
                let Some(length) = bytes.get(at..at + 2) else {
                    return false;
                };
                at += usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
            }
        }
    }
}

/// The next marker at or after `from`: 0xFF followed by neither a stuffed zero nor another fill byte.
fn find_marker(bytes: &[u8], from: usize) -> Option<usize> {
    let rest = bytes.get(from..)?;
    rest.windows(2)
        .position(|pair| pair[0] == 0xFF && !matches!(pair[1], 0x00 | 0xFF))
        .map(|i| from + i)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn small_jpeg() -> Vec<u8> {
        let picture = RgbImage::from_fn(64, 48, |x, y| {
            image::Rgb([(x * 4) as u8, (y * 5) as u8, ((x * y) % 256) as u8])
        });
        let mut bytes = Vec::new();
        picture
            .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg)
            .unwrap();
        bytes
    }

    #[test]
    fn a_whole_jpeg_decodes_and_trailing_bytes_do_not_matter() {
        let mut bytes = small_jpeg();
        assert_eq!(decode(&bytes).unwrap().rgb.dimensions(), (64, 48));
        bytes.extend_from_slice(b"motion photo video");
        assert_eq!(decode(&bytes).unwrap().rgb.dimensions(), (64, 48));
    }

    #[test]
    fn every_cut_is_noticed() {
        let bytes = small_jpeg();
        for keep in 3..bytes.len() {
            assert!(
                decode(&bytes[..keep]).is_err(),
                "a JPEG cut at byte {keep} of {} was accepted",
                bytes.len()
            );
        }
    }

    #[test]
    fn a_picture_that_claims_to_be_huge_is_refused_before_decoding() {
        let mut bytes = Vec::new();
        RgbImage::new(1, 1)
            .write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png)
            .unwrap();
        // Width and height stand in the header chunk, whose checksum follows them; without a right one it is damaged.
        bytes[16..24].copy_from_slice(&[0, 1, 0x86, 0xA0, 0, 1, 0x86, 0xA0]);
        let crc = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.to_be_bytes());
        assert_eq!(decode(&bytes).unwrap_err(), DecodeProblem::TooLarge(10_000));
    }

    /// CRC-32 as PNG uses it (RFC 2083, 15), bit by bit.
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, b| {
            (0..8).fold(crc ^ u32::from(*b), |c, _| {
                if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 }
            })
        })
    }

    /// Most damage inside a JPEG decodes into some other picture; what the strict decoder can notice is refused, where the
    /// lenient one refuses none of these.
    #[test]
    fn damage_that_can_be_noticed_is_refused() {
        let photo = concat!(env!("CARGO_MANIFEST_DIR"), "/captures/skyline/normal_000.jpg");
        let bytes = std::fs::read(photo).unwrap();
        let mut random = 1_u64;
        let mut next = || {
            random = random
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (random >> 33) as usize
        };
        let refused = (0..60).filter(|_| {
            let mut copy = bytes.clone();
            for _ in 0..20 {
                let at = 700 + next() % (copy.len() - 702);
                copy[at] = next() as u8;
            }
            decode(&copy).is_err()
        });
        assert!(refused.count() >= 6);
    }

    #[test]
    fn text_is_not_a_picture() {
        assert_eq!(
            decode(b"this is a shopping list").unwrap_err(),
            DecodeProblem::NotAPicture
        );
        assert_eq!(decode(b"").unwrap_err(), DecodeProblem::NotAPicture);
    }

    proptest! {
        /// User files of any content: an error or a picture, never a panic.
        #[test]
        fn damaged_jpegs_never_panic(at in 2usize..600, value in any::<u8>()) {
            let mut bytes = small_jpeg();
            let at = at % bytes.len();
            bytes[at] = value;
            let _ = decode(&bytes);
        }
    }
}
