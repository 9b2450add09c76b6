//! Any image as colours: a photo, a texture, an atlas, a pattern that was enlarged.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::codecs::webp::WebPDecoder;
use image::{DynamicImage, ImageDecoder, ImageFormat, RgbImage};

use super::{light, numpy};
use scaleproof_core::files;
use scaleproof_photo::{Budget, DecodeCost, DecodeProblem, Photo, PhotoError, open_png};

/// Largest number of pixels along a side: as many as graphics cards take.
const MAX_PIXELS: u32 = 16_384;

/// Size of the largest file that NumPy saved, bytes.
const MOST_ARRAY_BYTES: u64 = 1 << 30;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the image {path} cannot be used ({reason})", path = path.display())]
pub struct PictureError {
    pub path: PathBuf,
    pub reason: String,
}

/// An opaque image in 8-bit sRGB.
#[derive(Debug, Clone)]
pub struct Picture {
    pub pixels: Arc<RgbImage>,
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// Change that was made to it, as a clause.
    pub note: Option<String>,
}

impl Picture {
    /// Reads any image that can be a photo, or an array that NumPy saved.
    pub fn load(path: &Path) -> Result<Self, PictureError> {
        let bad = |reason: String| PictureError {
            path: path.to_owned(),
            reason,
        };
        if path.extension().is_some_and(|ending| ending == "npy") {
            let bytes = files::read_at_most(path, MOST_ARRAY_BYTES).map_err(|e| bad(e.to_string()))?;
            return Self::from_bytes(&bytes, None).map_err(bad);
        }
        let photo = Photo::open(path).map_err(|e| bad(reason(e)))?;
        Self::from_bytes(photo.bytes(), Some(1.0)).map_err(bad)
    }

    /// Decodes a PNG, a JPEG, a WebP, or NumPy's array of colours. `alpha` is the factor of its alpha: pixels that are see-through then are laid on
    /// white, as paper is; `None` leaves the colours as they are. The error is a clause.
    ///
    /// # Errors
    /// A damaged file, 16-bit and CMYK images, more than [`MAX_PIXELS`] along a side.
    pub fn from_bytes(bytes: &[u8], alpha: Option<f64>) -> Result<Self, String> {
        if bytes.starts_with(numpy::MAGIC) {
            return Ok(Self {
                pixels: Arc::new(numpy::image(bytes, MAX_PIXELS)?),
                sha256: files::sha256_hex(bytes),
                note: Some("is an array: its colours are taken for red, green, blue, in this order".into()),
            });
        }
        let image = match image::guess_format(bytes) {
            Ok(ImageFormat::Png) => png(bytes)?,
            Ok(ImageFormat::WebP) => webp(bytes)?,
            _ => jpeg(bytes)?.into(),
        };
        let (pixels, share) = match alpha.filter(|alpha| image.color().has_alpha() || *alpha < 1.0) {
            Some(alpha) => on_white(image, alpha),
            None => (image.into_rgb8(), 0.0),
        };
        let percent = 100.0 * share;
        let note = || format!("is see-through in {percent:.1} % of its pixels, which are laid on white");
        Ok(Self {
            pixels: Arc::new(pixels),
            sha256: files::sha256_hex(bytes),
            note: (share > 0.0).then(note),
        })
    }

    /// Returns the height for a width that keeps the image's proportions.
    pub fn height_for(&self, width: f64) -> f64 {
        width * f64::from(self.pixels.height()) / f64::from(self.pixels.width())
    }
}

fn png(bytes: &[u8]) -> Result<DynamicImage, String> {
    let decoder = open_png(bytes, &Budget::FILE).map_err(|e| e.to_string())?;
    check_size(decoder.dimensions())?;
    let colour = decoder.color_type();
    if colour.bytes_per_pixel() > colour.channel_count() {
        return Err("it has 16 bits a channel, which often are no sRGB: save it with 8, as sRGB".into());
    }
    DynamicImage::from_decoder(decoder).map_err(|e| format!("it is damaged: {e}"))
}

/// Decodes a WebP, as in glTF files (`EXT_texture_webp`); of a moving one the first image.
fn webp(bytes: &[u8]) -> Result<DynamicImage, String> {
    let damaged = |e: image::ImageError| format!("it is damaged: {e}");
    let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(damaged)?;
    check_size(decoder.dimensions())?;
    let bytes_per_pixel = decoder.color_type().bytes_per_pixel().into();
    let cost = DecodeCost::of_png(decoder.dimensions().into(), bytes_per_pixel, false);
    Budget::FILE.check(&cost).map_err(|e| e.to_string())?;
    DynamicImage::from_decoder(decoder).map_err(damaged)
}

fn jpeg(bytes: &[u8]) -> Result<RgbImage, String> {
    let photo = Photo::from_bytes(Path::new(""), bytes.to_vec(), Budget::FILE).map_err(reason)?;
    check_size((photo.width, photo.height))?;
    if photo.is_cmyk() {
        return Err("its colours are printing inks, CMYK, whose look the file leaves open: save it as sRGB".into());
    }
    photo.rgb(1).map_err(reason)
}

fn check_size((width, height): (u32, u32)) -> Result<(), String> {
    let refused = || format!("it has {width}×{height} pixels, more than {MAX_PIXELS} along a side: scale it down");
    let is_fine = width.max(height) <= MAX_PIXELS;
    is_fine.then_some(()).ok_or_else(refused)
}

/// Returns the reason as a clause. Photos are copied again; other images are saved again.
fn reason(error: PhotoError) -> String {
    let PhotoError::Bytes { problem, .. } = &error else {
        return error.to_string();
    };
    match problem {
        DecodeProblem::NotAnImage => "it is neither PNG nor JPEG".to_owned(),
        DecodeProblem::Truncated => "it ends in the middle: save it again".to_owned(),
        DecodeProblem::Damaged(reason) => format!("it is damaged: {reason}"),
        DecodeProblem::TooLarge(size) => format!("it has {size}: scale it down"),
        DecodeProblem::TooManyScans(scans) => format!("it has {scans} scans, which take too long to decode"),
        DecodeProblem::Heif(_) => error.to_string(),
    }
}

/// Lays an image on white; returns the colours, and the share of pixels that let it through.
fn on_white(image: DynamicImage, factor: f64) -> (RgbImage, f64) {
    let image = image.into_rgba8();
    let mut seen_through = 0_usize;
    let mut pixels = RgbImage::new(image.width(), image.height());
    for (pixel, stored) in pixels.pixels_mut().zip(image.pixels()) {
        let [r, g, b, alpha] = stored.0;
        let share = factor * f64::from(alpha) / 255.0;
        pixel.0 = if share >= 1.0 {
            [r, g, b]
        } else {
            seen_through += 1;
            light::rgb_of(light::linear_of([r, g, b]).map(|c| share * c + 1.0 - share))
        };
    }
    let count = u64::from(image.width()) * u64::from(image.height());
    (pixels, seen_through as f64 / count.max(1) as f64)
}
