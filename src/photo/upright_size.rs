//! The size of a photo without decoding it.

use std::io::Cursor;
use std::path::Path;

use image::metadata::Orientation;
use image::{ImageDecoder, ImageReader};

use super::{PhotoError, damaged, turned_deg};
use crate::files;

/// Width and height in px of a JPEG or PNG file, turned upright by its EXIF orientation, from its header.
///
/// # Errors
/// A file that cannot be read, or is no picture. That the picture is whole is not looked at.
pub fn upright_size(path: &Path) -> Result<[u32; 2], PhotoError> {
    let bytes = files::read(path)?;
    let format = super::known_format(&bytes).ok_or_else(|| PhotoError::NotAPicture { path: path.to_owned() })?;
    let failed = |e| super::refusal(path, damaged(e));
    let decoder = ImageReader::with_format(Cursor::new(&bytes), format).into_decoder();
    let mut decoder = decoder.map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    Ok(match turned_deg(orientation) {
        90 | 270 => [height, width],
        _ => [width, height],
    })
}
