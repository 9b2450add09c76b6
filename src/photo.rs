//! Photos: decoded upright, or refused with the reason. A file is never written back.

mod budget;
mod file;
mod heif;
mod lens;
mod outline;

use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::codecs::png::PngDecoder;
use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageFormat, RgbImage};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use crate::files;

pub use budget::Budget;
use budget::Cost;
pub use file::PhotoFile;
pub use heif::reads_heif;
pub use lens::Lens;
use outline::Outline;

/// Why a photo could not be used.
#[derive(Debug, thiserror::Error)]
pub enum PhotoError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("{path} is not a JPEG or PNG picture: use a photo straight from the camera", path = path.display())]
    NotAPicture { path: PathBuf },
    #[error("{}", convert_sentence(path, kind))]
    Heif { path: PathBuf, kind: &'static str },
    #[error("{path} ends in the middle of the picture: copy it from the camera again", path = path.display())]
    Truncated { path: PathBuf },
    #[error("{path} has {size}: scale it down", path = path.display())]
    TooLarge { path: PathBuf, size: String },
    #[error("{path} is a JPEG of {scans} scans, which no camera writes and which take too long to decode: save it again", path = path.display())]
    TooManyScans { path: PathBuf, scans: u64 },
    #[error("{path} cannot be decoded ({reason}): copy it from the camera again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
}

/// What to do with a picture of another kind that phones make.
fn convert_sentence(path: &Path, kind: &str) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let how = match kind {
        "HEIC" => "set the iPhone to Settings › Camera › Formats › Most Compatible, or convert it",
        _ => "convert it to JPEG",
    };
    format!(
        "{} is {} {kind} picture, which this program does not read: {how} with `heif-dec '{name}' '{stem}.jpg'` (Debian: apt install \
         libheif-examples, where it may be called heif-convert), and see that it stands upright",
        path.display(),
        if kind == "AVIF" { "an" } else { "a" },
    )
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
    /// Reads and decodes a JPEG or PNG file, whatever its name says, or an HEIC file where the system has a decoder.
    pub fn open(path: &Path) -> Result<Photo, PhotoError> {
        let bytes = files::read_at_most(path, Budget::FILE.bytes)?;
        let converted = converted(path, &bytes)?;
        let picture = converted.as_deref().unwrap_or(&bytes);
        let mut decoded = decode(picture, &Budget::FILE).map_err(|problem| problem.at(path))?;
        if let Some(exif) = converted.as_ref().and_then(|_| heif::exif(&bytes)) {
            decoded.turned_deg = turned_deg(orientation_of(Some(&exif)));
            decoded.lens = Lens::from_exif(exif);
        }
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

/// An HEIF file as a PNG; `None` for other files, and where the system has no decoder.
fn converted(path: &Path, bytes: &[u8]) -> Result<Option<Vec<u8>>, PhotoError> {
    match heif_kind(bytes) {
        Some(_) => heif::as_png(path, bytes),
        None => Ok(None),
    }
}

/// What is wrong with the bytes of a picture.
#[derive(Debug, PartialEq)]
enum DecodeProblem {
    NotAPicture,
    /// Its kind.
    Heif(&'static str),
    Truncated,
    /// How large, as a clause.
    TooLarge(String),
    TooManyScans(u64),
    Damaged(String),
}

impl DecodeProblem {
    fn at(self, path: &Path) -> PhotoError {
        let path = path.to_owned();
        match self {
            DecodeProblem::NotAPicture => PhotoError::NotAPicture { path },
            DecodeProblem::Heif(kind) => PhotoError::Heif { path, kind },
            DecodeProblem::Truncated => PhotoError::Truncated { path },
            DecodeProblem::TooLarge(size) => PhotoError::TooLarge { path, size },
            DecodeProblem::TooManyScans(scans) => PhotoError::TooManyScans { path, scans },
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

fn decode(bytes: &[u8], budget: &Budget) -> Result<Decoded, DecodeProblem> {
    let (picture, exif) = match Kind::of(bytes)? {
        Kind::Jpeg(outline) => decode_jpeg(bytes, &outline, budget)?,
        Kind::Png => decode_png(bytes, budget)?,
    };
    let orientation = orientation_of(exif.as_deref());
    let mut picture = DynamicImage::from(picture.into_rgb8());
    picture.apply_orientation(orientation);
    Ok(Decoded {
        rgb: picture.into_rgb8(),
        turned_deg: turned_deg(orientation),
        lens: exif.map(Lens::from_exif).unwrap_or_default(),
    })
}

/// A PNG whose header was read and is within the budget; the reader decides about size and kind before it decodes.
///
/// # Errors
/// What is no PNG, is damaged or costs too much, as a clause.
pub fn open_png<'a>(bytes: &'a [u8], budget: &Budget) -> Result<impl ImageDecoder + 'a, String> {
    let opened = png_header(bytes, budget).map_err(|problem| match problem {
        DecodeProblem::TooLarge(size) => format!("it has {size}"),
        DecodeProblem::Damaged(reason) => reason,
        _ => "it is no PNG".into(),
    });
    opened.map(|(decoder, _)| decoder)
}

/// JPEG or PNG, by the first bytes.
enum Kind {
    Jpeg(Outline),
    Png,
}

impl Kind {
    /// A cut JPEG ends here: decoders fill its missing rows with grey and call it a success.
    fn of(bytes: &[u8]) -> Result<Kind, DecodeProblem> {
        match image::guess_format(bytes) {
            Ok(ImageFormat::Jpeg) => Ok(Kind::Jpeg(Outline::of(bytes).ok_or(DecodeProblem::Truncated)?)),
            Ok(ImageFormat::Png) => Ok(Kind::Png),
            _ => Err(heif_kind(bytes).map_or(DecodeProblem::NotAPicture, DecodeProblem::Heif)),
        }
    }
}

/// The kind of an HEIF file (ISO 23008-12, 10: its brands), by the `ftyp` box that it begins with.
fn heif_kind(bytes: &[u8]) -> Option<&'static str> {
    let length = u32::from_be_bytes(*bytes.first_chunk()?) as usize;
    let ftyp = bytes.get(4..length.min(bytes.len()).min(LONGEST_FTYP))?;
    // The major brand, a version, and the brands that the file fits as well.
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

/// Files name a handful of brands, 4 bytes each.
const LONGEST_FTYP: usize = 1024;

/// What EXIF data says; data that cannot be read is no reason to refuse the picture.
fn orientation_of(exif: Option<&[u8]>) -> Orientation {
    let read = exif.and_then(Orientation::from_exif_chunk);
    read.unwrap_or(Orientation::NoTransforms)
}

/// True when an orientation swaps width and height.
fn lies_across(orientation: Orientation) -> bool {
    turned_deg(orientation) % 180 == 90
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

fn decode_png(bytes: &[u8], budget: &Budget) -> Result<Stored, DecodeProblem> {
    let (mut decoder, _) = png_header(bytes, budget)?;
    // EXIF data that cannot be read is no reason to refuse the picture.
    let exif = decoder.exif_metadata().ok().flatten();
    Ok((DynamicImage::from_decoder(decoder).map_err(damaged)?, exif))
}

/// Colour profiles and texts that a PNG's header is unpacked into, bytes; not its pixels.
const PNG_CHUNKS: u64 = 64 << 20;

/// A decoder that has read the header, and what the picture takes.
type OpenedPng<'a> = (PngDecoder<Cursor<&'a [u8]>>, Cost);

fn png_header<'a>(bytes: &'a [u8], budget: &Budget) -> Result<OpenedPng<'a>, DecodeProblem> {
    budget.check_bytes(bytes.len())?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(PNG_CHUNKS);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let is_turned = lies_across(orientation_of(decoder.exif_metadata().ok().flatten().as_deref()));
    let bytes_per_pixel = decoder.color_type().bytes_per_pixel().into();
    let cost = Cost::of_png([width, height], bytes_per_pixel, is_turned);
    budget.check(&cost)?;
    Ok((decoder, cost))
}

fn decode_jpeg(bytes: &[u8], outline: &Outline, budget: &Budget) -> Result<Stored, DecodeProblem> {
    let (pixels, [width, height], exif) = jpeg_pixels(bytes, outline, ColorSpace::RGB, budget)?;
    let picture = RgbImage::from_raw(width, height, pixels).ok_or_else(|| damaged("it is no RGB picture"))?;
    Ok((picture.into(), exif))
}

/// Pixels as they are stored, width and height, EXIF data.
type JpegPixels = (Vec<u8>, [u32; 2], Option<Vec<u8>>);

fn jpeg_pixels(
    bytes: &[u8],
    outline: &Outline,
    colours: ColorSpace,
    budget: &Budget,
) -> Result<JpegPixels, DecodeProblem> {
    let (mut decoder, [width, height], _) = jpeg_header(bytes, outline, colours, budget)?;
    let pixels = decoder.decode().map_err(damaged)?;
    Ok((pixels, [width, height], decoder.exif().cloned()))
}

/// A decoder that has read the header, the picture's width and height, and what it takes.
type OpenedJpeg<'a> = (JpegDecoder<ZCursor<&'a [u8]>>, [u32; 2], Cost);

/// Strict: by default it fills what damaged data leaves open with grey.
fn jpeg_header<'a>(
    bytes: &'a [u8],
    outline: &Outline,
    colours: ColorSpace,
    budget: &Budget,
) -> Result<OpenedJpeg<'a>, DecodeProblem> {
    budget.check_bytes(bytes.len())?;
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_max_scans(Budget::SCANS as usize)
        .jpeg_set_out_colorspace(colours);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().ok_or_else(|| damaged("it has no size"))?;
    // A JPEG's sides fit 16 bits.
    let size = [width as u32, height as u32];
    let is_turned = lies_across(orientation_of(decoder.exif().map(Vec::as_slice)));
    let cost = Cost::of_jpeg(size, outline, is_turned);
    budget.check(&cost)?;
    Ok((decoder, size, cost))
}

/// The first line of what a decoder says, without the internals it prints in braces.
fn damaged(e: impl std::fmt::Display) -> DecodeProblem {
    let text = e.to_string();
    let line = text.lines().next().unwrap_or_default();
    DecodeProblem::Damaged(line.split(" {").next().unwrap_or(line).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decode(bytes: &[u8]) -> Result<Decoded, DecodeProblem> {
        super::decode(bytes, &Budget::FILE)
    }

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
        let problem = decode(&bytes).unwrap_err();
        assert!(
            matches!(&problem, DecodeProblem::TooLarge(size) if size.starts_with("10000 megapixels")),
            "{problem:?}"
        );
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

    #[test]
    fn pictures_of_iphones_are_known_by_their_brands() {
        let ftyp = |brands: &[u8]| {
            [
                &(8 + brands.len() as u32).to_be_bytes()[..],
                b"ftyp",
                brands,
                b"\0\0\0\x08mdat",
            ]
            .concat()
        };
        for (brands, kind) in [
            (&b"heic\0\0\0\0mif1heic"[..], Some("HEIC")),
            (b"mif1\0\0\0\0mif1heix", Some("HEIC")),
            (b"mif1\0\0\0\0mif1", Some("HEIF")),
            (b"avif\0\0\0\0avifmif1miaf", Some("AVIF")),
            (b"isom\0\0\x02\0isomiso2", None),
            (b"", None),
        ] {
            let file = ftyp(brands);
            let problem = kind.map_or(DecodeProblem::NotAPicture, DecodeProblem::Heif);
            assert_eq!(decode(&file).unwrap_err(), problem, "{}", brands.escape_ascii());
            for cut in 0..file.len() {
                let _ = decode(&file[..cut]);
            }
        }
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
