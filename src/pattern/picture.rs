//! Any image: a photo, a texture, a pattern that was enlarged.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::{ColorType, DynamicImage, ImageDecoder, RgbImage};

use crate::photo::{Budget, Photo, PhotoError, open_png};

/// Most pixels along a side: at 600 dpi that is 35 cm.
pub(crate) const MAX_PIXELS: u32 = 8192;

/// Why an image cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the image {path} cannot be used ({reason})", path = path.display())]
pub(crate) struct PictureError {
    pub path: PathBuf,
    pub reason: String,
}

/// An opaque image in 8-bit sRGB.
#[derive(Debug, Clone)]
pub(crate) struct Picture {
    pixels: Arc<RgbImage>,
    sha256: String,
}

impl Picture {
    /// Reads what photos are read from.
    ///
    /// # Errors
    /// An unreadable or damaged file, see-through pixels, 16-bit and CMYK images, more than [`MAX_PIXELS`] along a side.
    pub(crate) fn load(path: &Path) -> Result<Self, PictureError> {
        let bad = |reason: String| PictureError {
            path: path.to_owned(),
            reason,
        };
        let photo = Photo::open(path).map_err(|e| bad(reason(e)))?;
        let (width, height) = (photo.width, photo.height);
        if width > MAX_PIXELS || height > MAX_PIXELS {
            return Err(bad(format!(
                "it has {width}×{height} pixels, more than {MAX_PIXELS} along a side: scale it down"
            )));
        }
        if photo.is_cmyk() {
            return Err(bad(
                "its colours are printing inks, CMYK, whose look the file leaves open: save it as sRGB".into(),
            ));
        }
        if photo.extension() == "png" {
            check_png(photo.bytes()).map_err(bad)?;
        }
        Ok(Self {
            pixels: Arc::new(photo.rgb(1).map_err(|e| bad(reason(e)))?),
            sha256: photo.sha256,
        })
    }

    pub(crate) fn pixels(&self) -> &Arc<RgbImage> {
        &self.pixels
    }

    /// SHA-256 of the file, hex.
    pub(crate) fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Height for a width that keeps the image's proportions.
    pub(crate) fn height_for(&self, width: f64) -> f64 {
        width * f64::from(self.pixels.height()) / f64::from(self.pixels.width())
    }
}

/// Photos are copied again; other images are saved again.
fn reason(error: PhotoError) -> String {
    match error {
        PhotoError::NotAnImage { .. } => "it is neither PNG nor JPEG".to_owned(),
        PhotoError::Truncated { .. } => "it ends in the middle: save it again".to_owned(),
        PhotoError::Damaged { reason, .. } => format!("it is damaged: {reason}"),
        PhotoError::TooLarge { size, .. } => format!("it has {size}: scale it down"),
        other => other.to_string(),
    }
}

/// Refuses what a PNG says beyond opaque sRGB in 8 bits.
fn check_png(bytes: &[u8]) -> Result<(), String> {
    let decoder = open_png(bytes, &Budget::FILE).map_err(|e| e.to_string())?;
    let kind = decoder.color_type();
    if matches!(
        kind,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16
    ) {
        return Err("it has 16 bits a channel, which often are no sRGB: save it with 8, as sRGB".to_owned());
    }
    if !kind.has_alpha() {
        return Ok(());
    }
    let image = DynamicImage::from_decoder(decoder).map_err(|e| format!("it is damaged: {e}"))?;
    match image.to_luma_alpha8().pixels().all(|p| p.0[1] == u8::MAX) {
        true => Ok(()),
        false => Err("it is see-through in places: flatten it onto an opaque colour".to_owned()),
    }
}
