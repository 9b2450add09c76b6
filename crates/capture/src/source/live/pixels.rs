//! Images of cameras: a motion JPEG becomes the JPEG file it almost is, raw pixels become colours.

use image::{GrayImage, RgbImage};
use opencv::core::{Mat, MatTraitConst, MatTraitConstManual};
use opencv::imgproc;

use crate::source::Original;
use scaleproof_photo::standard_huffman_tables;

/// Format in which a camera packs its pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelFormat {
    /// One JPEG an image, often without the Huffman tables that all of them share.
    Mjpeg,
    /// Y'CbCr 4:2:2 of BT.601, video range, as Y U Y V.
    Yuyv,
    /// Y'CbCr 4:2:0 of BT.601, video range: all Y, then pairs U V.
    Nv12,
    Grey,
    Rgb,
    Bgr,
}

/// An image as the camera sent it. The bytes may go on behind it: drivers hand out whole buffers.
#[derive(Debug, Clone)]
pub struct RawImage {
    pub format: PixelFormat,
    pub width: u32,
    pub height: u32,
    pub bytes: Vec<u8>,
}

const BROKEN: &str = "the camera sent half an image: check its cable";

impl RawImage {
    /// Returns the file or the pixels to keep of it.
    ///
    /// # Errors
    /// A sentence, for an image that is not whole.
    pub fn original(self) -> Result<Original, &'static str> {
        if self.format == PixelFormat::Mjpeg {
            return Ok(Original::Encoded(jpeg_file(&self.bytes).ok_or(BROKEN)?));
        }
        let upright = self.colours().ok_or(BROKEN)?;
        Ok(Original::Pixels(upright))
    }

    fn colours(mut self) -> Option<RgbImage> {
        let (width, height) = (self.width, self.height);
        let pixels = width as usize * height as usize;
        // Whole pairs of columns (and rows) only, as the formats have them.
        let (bytes, is_even) = match self.format {
            PixelFormat::Mjpeg => return None,
            PixelFormat::Yuyv => (2 * pixels, width.is_multiple_of(2)),
            PixelFormat::Nv12 => (pixels * 3 / 2, width.is_multiple_of(2) && height.is_multiple_of(2)),
            PixelFormat::Grey => (pixels, true),
            PixelFormat::Rgb | PixelFormat::Bgr => (3 * pixels, true),
        };
        if !is_even || pixels == 0 || self.bytes.len() < bytes {
            return None;
        }
        self.bytes.truncate(bytes);
        match self.format {
            PixelFormat::Yuyv => converted::<2>(&self.bytes, [width, height], imgproc::COLOR_YUV2RGB_YUY2),
            PixelFormat::Nv12 => converted::<1>(&self.bytes, [width, height / 2 * 3], imgproc::COLOR_YUV2RGB_NV12),
            PixelFormat::Grey => {
                let grey = GrayImage::from_raw(width, height, self.bytes)?;
                Some(image::DynamicImage::from(grey).into_rgb8())
            }
            _ => {
                if self.format == PixelFormat::Bgr {
                    self.bytes.as_chunks_mut::<3>().0.iter_mut().for_each(|p| p.reverse());
                }
                RgbImage::from_raw(width, height, self.bytes)
            }
        }
    }
}

/// Converts pixels of `CHANNELS` bytes to RGB by OpenCV; `None` if it fails, as on an image that is not whole.
fn converted<const CHANNELS: usize>(bytes: &[u8], [columns, rows]: [u32; 2], code: i32) -> Option<RgbImage> {
    let channels = i32::try_from(CHANNELS).ok()?;
    let raw = Mat::from_slice(bytes).ok()?;
    let raw = raw.reshape(channels, i32::try_from(rows).ok()?).ok()?;
    let mut rgb = Mat::default();
    imgproc::cvt_color_def(&raw, &mut rgb, code).ok()?;
    let height = u32::try_from(rgb.rows()).ok()?;
    RgbImage::from_raw(columns, height, rgb.data_bytes().ok()?.to_vec())
}

/// Returns the JPEG file in a buffer: what follows its end is left out, and the standard's Huffman tables are put in where it has none.
/// `None` when it is not whole.
fn jpeg_file(buffer: &[u8]) -> Option<Vec<u8>> {
    let segments = Segments::read(buffer)?;
    // In the scan, 0xFF is followed by 0 or a restart marker; so the first end marker is the image's own.
    let scan = &buffer[segments.scan..];
    let end = segments.scan + 2 + scan.windows(2).position(|pair| pair == [0xFF, END])?;
    let mut file = buffer[..segments.scan].to_vec();
    if !segments.has_tables {
        file.extend(standard_huffman_tables());
    }
    file.extend_from_slice(&buffer[segments.scan..end]);
    Some(file)
}

const START: u8 = 0xD8;
const END: u8 = 0xD9;
const HUFFMAN: u8 = 0xC4;
const SCAN: u8 = 0xDA;

/// Places of the parts of a JPEG before its pixels (ITU-T T.81, annex B).
struct Segments {
    /// True if Huffman tables are among them.
    has_tables: bool,
    /// Place of the marker that begins the scan.
    scan: usize,
}

/// Returns the width and height that a JPEG states, px.
pub fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let reader = image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Jpeg);
    reader.into_dimensions().ok().map(|(width, height)| [width, height])
}

impl Segments {
    fn read(bytes: &[u8]) -> Option<Segments> {
        if !bytes.starts_with(&[0xFF, START]) {
            return None;
        }
        let (mut at, mut has_tables) = (2, false);
        loop {
            let [0xFF, marker, high, low] = *bytes.get(at..at + 4)? else {
                return None;
            };
            let next = at + 2 + usize::from(u16::from_be_bytes([high, low])).max(2);
            match marker {
                SCAN => return Some(Segments { has_tables, scan: at }),
                HUFFMAN => has_tables = true,
                _ => {}
            }
            at = next;
        }
    }
}
