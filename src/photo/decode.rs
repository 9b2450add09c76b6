//! From the bytes of a JPEG or PNG file to upright pixels, whole or not at all.

use std::io::Cursor;

use image::codecs::png::PngDecoder;
use image::metadata::Orientation;
use image::{DynamicImage, GrayImage, ImageDecoder, ImageFormat, RgbImage, imageops};
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

use super::budget::{Budget, DecodeCost};
use super::problem::DecodeProblem;
use super::structure::JpegStructure;

/// JPEG or PNG, by the first bytes.
enum FileKind {
    Jpeg(JpegStructure),
    Png,
}

impl FileKind {
    /// A cut JPEG ends here: decoders fill its missing rows with grey and call it a success.
    fn of(bytes: &[u8]) -> Result<FileKind, DecodeProblem> {
        match image::guess_format(bytes) {
            Ok(ImageFormat::Jpeg) => Ok(FileKind::Jpeg(
                JpegStructure::of(bytes).ok_or(DecodeProblem::Truncated)?,
            )),
            Ok(ImageFormat::Png) => Ok(FileKind::Png),
            _ => Err(heif_kind(bytes).map_or(DecodeProblem::NotAnImage, DecodeProblem::Heif)),
        }
    }
}

/// The kind of an HEIF file (ISO 23008-12, 10: its brands), by the `ftyp` box that it begins with.
pub(super) fn heif_kind(bytes: &[u8]) -> Option<&'static str> {
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

/// What EXIF data says; data that cannot be read is no reason to refuse the image.
pub(super) fn orientation_of(exif: Option<&[u8]>) -> Orientation {
    let read = exif.and_then(Orientation::from_exif_chunk);
    read.unwrap_or(Orientation::NoTransforms)
}

/// True when an orientation swaps width and height.
fn lies_across(orientation: Orientation) -> bool {
    turned_deg(orientation) % 180 == 90
}

/// How far the sensor's image is turned clockwise; mirroring is what software did to it before.
pub(super) fn turned_deg(orientation: Orientation) -> u32 {
    match orientation {
        Orientation::NoTransforms | Orientation::FlipHorizontal => 0,
        Orientation::Rotate90 | Orientation::Rotate270FlipH => 90,
        Orientation::Rotate180 | Orientation::FlipVertical => 180,
        Orientation::Rotate270 | Orientation::Rotate90FlipH => 270,
    }
}

/// What stands at the beginning of an image file.
#[derive(Debug)]
pub(super) struct Header {
    /// Width, height as stored.
    size: [u32; 2],
    pub cost: DecodeCost,
    pub orientation: Orientation,
    /// `None` for a PNG.
    pub jpeg: Option<JpegStructure>,
    /// A JPEG that stores luma by itself, as almost all do: the others are CMYK or plain RGB.
    pub has_luma: bool,
    /// A JPEG for print.
    pub is_cmyk: bool,
}

impl Header {
    /// Also gives the EXIF block.
    pub(super) fn of(bytes: &[u8], budget: &Budget) -> Result<(Header, Option<Vec<u8>>), DecodeProblem> {
        let (size, cost, exif, jpeg, colours) = match FileKind::of(bytes)? {
            FileKind::Jpeg(structure) => {
                let (decoder, size, cost) = jpeg_header(bytes, &structure, ColorSpace::RGB, budget)?;
                let colours = decoder.input_colorspace();
                (size, cost, decoder.exif().cloned(), Some(structure), colours)
            }
            FileKind::Png => {
                let (mut decoder, cost) = png_header(bytes, budget)?;
                let (width, height) = decoder.dimensions();
                let exif = decoder.exif_metadata().ok().flatten();
                ([width, height], cost, exif, None, None)
            }
        };
        let orientation = orientation_of(exif.as_deref());
        let header = Header {
            size,
            cost,
            orientation,
            jpeg,
            has_luma: matches!(colours, Some(ColorSpace::YCbCr | ColorSpace::Luma)),
            is_cmyk: matches!(colours, Some(ColorSpace::CMYK | ColorSpace::YCCK)),
        };
        Ok((header, exif))
    }

    /// Width and height of the upright image.
    pub(super) fn upright_size(&self) -> [u32; 2] {
        let [width, height] = self.size;
        match lies_across(self.orientation) {
            true => [height, width],
            false => [width, height],
        }
    }

    pub(super) fn luma(&self, bytes: &[u8], budget: &Budget) -> Result<GrayImage, DecodeProblem> {
        let Some(structure) = self.jpeg.filter(|_| self.has_luma) else {
            return Ok(imageops::grayscale(&self.rgb(bytes, budget)?));
        };
        let (pixels, [width, height]) = jpeg_pixels(bytes, &structure, ColorSpace::Luma, budget)?;
        let luma = GrayImage::from_raw(width, height, pixels).ok_or_else(|| damaged("it is no grey image"))?;
        Ok(self.upright(luma.into()).into_luma8())
    }

    pub(super) fn rgb(&self, bytes: &[u8], budget: &Budget) -> Result<RgbImage, DecodeProblem> {
        let stored = match &self.jpeg {
            Some(structure) => {
                let (pixels, [width, height]) = jpeg_pixels(bytes, structure, ColorSpace::RGB, budget)?;
                RgbImage::from_raw(width, height, pixels).ok_or_else(|| damaged("it is no RGB image"))?
            }
            None => {
                let (decoder, _) = png_header(bytes, budget)?;
                DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb8()
            }
        };
        Ok(self.upright(stored.into()).into_rgb8())
    }

    /// Colours at 1/`reduction` of the size.
    pub(super) fn reduced_rgb(&self, bytes: &[u8], budget: &Budget, reduction: u32) -> Result<RgbImage, DecodeProblem> {
        match reduced(bytes, self.size.map(|side| side / reduction))? {
            Some(reduced) => Ok(self.upright(reduced.into()).into_rgb8()),
            None => {
                let [width, height] = self.upright_size().map(|side| side / reduction);
                Ok(imageops::thumbnail(&self.rgb(bytes, budget)?, width, height))
            }
        }
    }

    fn upright(&self, mut stored: DynamicImage) -> DynamicImage {
        stored.apply_orientation(self.orientation);
        stored
    }
}

/// Why bytes are no PNG that can be decoded, as a clause.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum PngError {
    #[error("it has {0}")]
    TooLarge(String),
    #[error("{0}")]
    Damaged(String),
    #[error("it is no PNG")]
    NotAPng,
}

/// A PNG whose header was read and is within the budget; the reader decides about size and kind before it decodes.
pub(crate) fn open_png<'a>(bytes: &'a [u8], budget: &Budget) -> Result<impl ImageDecoder + 'a, PngError> {
    match png_header(bytes, budget) {
        Ok((decoder, _)) => Ok(decoder),
        Err(DecodeProblem::TooLarge(size)) => Err(PngError::TooLarge(size)),
        Err(DecodeProblem::Damaged(reason)) => Err(PngError::Damaged(reason)),
        Err(_) => Err(PngError::NotAPng),
    }
}

/// Colour profiles and texts that a PNG's header is unpacked into, bytes; not its pixels.
const PNG_CHUNKS: u64 = 64 << 20;

/// A decoder that has read the header, and what the image takes.
type OpenedPng<'a> = (PngDecoder<Cursor<&'a [u8]>>, DecodeCost);

fn png_header<'a>(bytes: &'a [u8], budget: &Budget) -> Result<OpenedPng<'a>, DecodeProblem> {
    budget.check_bytes(bytes.len())?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(PNG_CHUNKS);
    let mut decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let is_turned = lies_across(orientation_of(decoder.exif_metadata().ok().flatten().as_deref()));
    let bytes_per_pixel = decoder.color_type().bytes_per_pixel().into();
    let cost = DecodeCost::of_png([width, height], bytes_per_pixel, is_turned);
    budget.check(&cost)?;
    Ok((decoder, cost))
}

/// Pixels as they are stored, width and height.
type JpegPixels = (Vec<u8>, [u32; 2]);

fn jpeg_pixels(
    bytes: &[u8],
    structure: &JpegStructure,
    colours: ColorSpace,
    budget: &Budget,
) -> Result<JpegPixels, DecodeProblem> {
    let (mut decoder, size, _) = jpeg_header(bytes, structure, colours, budget)?;
    Ok((decoder.decode().map_err(damaged)?, size))
}

/// A decoder that has read the header, the image's width and height, and what it takes.
type OpenedJpeg<'a> = (JpegDecoder<ZCursor<&'a [u8]>>, [u32; 2], DecodeCost);

/// Strict: by default it fills what damaged data leaves open with grey.
fn jpeg_header<'a>(
    bytes: &'a [u8],
    structure: &JpegStructure,
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
    let cost = DecodeCost::of_jpeg(size, structure, is_turned);
    budget.check(&cost)?;
    Ok((decoder, size, cost))
}

/// The first line of what a decoder says, without the internals it prints in braces.
fn damaged(e: impl std::fmt::Display) -> DecodeProblem {
    let text = e.to_string();
    let line = text.lines().next().unwrap_or_default();
    DecodeProblem::Damaged(line.split(" {").next().unwrap_or(line).to_owned())
}

/// A JPEG decoded at a half, a quarter or an eighth of its stored width and height (scaled inverse DCT). `None` for the rare
/// kinds that only the other decoder reads. The same damage is refused as at full size.
fn reduced(bytes: &[u8], [width, height]: [u32; 2]) -> Result<Option<RgbImage>, DecodeProblem> {
    let mut decoder = jpeg_decoder::Decoder::new(bytes);
    // A JPEG's sides fit 16 bits.
    let asked = (width as u16, height as u16);
    let decoded = decoder
        .scale(asked.0, asked.1)
        .and_then(|size| Ok((size, decoder.decode()?)));
    let (size, mut pixels) = match decoded {
        Ok(decoded) => decoded,
        Err(jpeg_decoder::Error::Unsupported(_)) => return Ok(None),
        Err(e) => return Err(damaged(e)),
    };
    let count = width as usize * height as usize;
    if pixels.len() == count {
        pixels = pixels.iter().flat_map(|grey| [*grey; 3]).collect();
    }
    match size == asked && pixels.len() == 3 * count {
        true => Ok(RgbImage::from_raw(width, height, pixels)),
        false => Err(damaged("its header contradicts itself")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decode(bytes: &[u8]) -> Result<RgbImage, DecodeProblem> {
        Header::of(bytes, &Budget::FILE)?.0.rgb(bytes, &Budget::FILE)
    }

    fn small_jpeg() -> Vec<u8> {
        let image = RgbImage::from_fn(64, 48, |x, y| {
            image::Rgb([(x * 4) as u8, (y * 5) as u8, ((x * y) % 256) as u8])
        });
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).unwrap();
        bytes
    }

    #[test]
    fn a_whole_jpeg_decodes_and_trailing_bytes_do_not_matter() {
        let mut bytes = small_jpeg();
        assert_eq!(decode(&bytes).unwrap().dimensions(), (64, 48));
        bytes.extend_from_slice(b"motion photo video");
        assert_eq!(decode(&bytes).unwrap().dimensions(), (64, 48));
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

    /// Most damage inside a JPEG decodes into some other image; what the strict decoder can notice is refused, where the
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
    fn text_is_not_an_image() {
        assert_eq!(
            decode(b"this is a shopping list").unwrap_err(),
            DecodeProblem::NotAnImage
        );
        assert_eq!(decode(b"").unwrap_err(), DecodeProblem::NotAnImage);
    }

    #[test]
    fn photos_of_iphones_are_known_by_their_brands() {
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
            let problem = kind.map_or(DecodeProblem::NotAnImage, DecodeProblem::Heif);
            assert_eq!(decode(&file).unwrap_err(), problem, "{}", brands.escape_ascii());
            for cut in 0..file.len() {
                let _ = decode(&file[..cut]);
            }
        }
    }

    proptest! {
        /// User files of any content: an error or an image, never a panic.
        #[test]
        fn damaged_jpegs_never_panic(at in 2usize..600, value in any::<u8>()) {
            let mut bytes = small_jpeg();
            let at = at % bytes.len();
            bytes[at] = value;
            let _ = decode(&bytes);
        }
    }
}
