//! An image file as texels: opaque, 8 bits, sRGB.

use std::path::Path;

use image::{DynamicImage, ImageFormat, RgbImage};

use crate::pattern::light;
use crate::photo::{Budget, Photo, PhotoError, open_png};

/// The pixels of an image, and what was done to it, as clauses.
#[derive(Debug)]
pub(super) struct Opened {
    pub pixels: RgbImage,
    pub notes: Vec<String>,
}

/// Decodes a PNG or JPEG. `alpha` is what its alpha is multiplied by: what is see-through then is laid on white, as paper is; `None` leaves
/// the colours as they are. The error is a clause.
pub(super) fn open(bytes: &[u8], alpha: Option<f64>) -> Result<Opened, String> {
    let image = match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => png(bytes)?,
        Ok(ImageFormat::Jpeg) => jpeg(bytes)?.into(),
        _ => return Err("it is neither PNG nor JPEG".into()),
    };
    let mut notes = Vec::new();
    let colour = image.color();
    if colour.bytes_per_pixel() > colour.channel_count() {
        notes.push("has 16 bits a channel, which are rounded to 8".into());
    }
    let Some(alpha) = alpha.filter(|alpha| colour.has_alpha() || *alpha < 1.0) else {
        return Ok(Opened {
            pixels: image.into_rgb8(),
            notes,
        });
    };
    let (pixels, share) = on_white(image, alpha);
    if share > 0.0 {
        notes.push(format!(
            "is see-through in {:.1} % of its pixels, which are laid on white",
            100.0 * share
        ));
    }
    Ok(Opened { pixels, notes })
}

fn png(bytes: &[u8]) -> Result<DynamicImage, String> {
    let decoder = open_png(bytes, &Budget::FILE).map_err(|e| e.to_string())?;
    DynamicImage::from_decoder(decoder).map_err(|e| format!("it is damaged: {e}"))
}

fn jpeg(bytes: &[u8]) -> Result<RgbImage, String> {
    let photo = Photo::from_bytes(Path::new(""), bytes.to_vec(), Budget::FILE).map_err(clause)?;
    if photo.is_cmyk() {
        return Err("it is a JPEG in CMYK, whose colours depend on a printer; save it in sRGB".into());
    }
    photo.rgb(1).map_err(clause)
}

/// What is wrong with a JPEG; the sentences of photos are for photographers.
fn clause(error: PhotoError) -> String {
    match error {
        PhotoError::TooLarge { size, .. } => format!("it has {size}"),
        PhotoError::Truncated { .. } => "it ends in the middle of the image".into(),
        PhotoError::Damaged { reason, .. } => format!("it is damaged: {reason}"),
        PhotoError::TooManyScans { scans, .. } => format!("it has {scans} scans, which take too long to decode"),
        other => other.to_string(),
    }
}

/// The colours over white, and the share of pixels that let it through.
fn on_white(image: DynamicImage, factor: f64) -> (RgbImage, f64) {
    let image = image.into_rgba8();
    let mut seen_through = 0_usize;
    let mut pixels = RgbImage::new(image.width(), image.height());
    for (pixel, stored) in pixels.pixels_mut().zip(image.pixels()) {
        let [r, g, b, alpha] = stored.0;
        let share = factor * f64::from(alpha) / 255.0;
        pixel.0 = match share >= 1.0 {
            true => [r, g, b],
            false => {
                seen_through += 1;
                light::rgb_of(light::linear_of([r, g, b]).map(|c| share * c + 1.0 - share))
            }
        };
    }
    let count = u64::from(image.width()) * u64::from(image.height());
    (pixels, seen_through as f64 / count.max(1) as f64)
}
