//! What JPEG makes of a picture.

use std::path::Path;

use image::RgbImage;

use super::{Budget, Photo, preview_jpeg};

/// The picture as it comes back from a JPEG of a quality, 1 to 100; `None` where there is no such JPEG.
pub fn as_jpeg(picture: &RgbImage, quality: u8) -> Option<RgbImage> {
    let jpeg = preview_jpeg(picture, quality)?;
    Photo::from_bytes(Path::new("picture"), jpeg, Budget::FILE)
        .ok()?
        .rgb(1)
        .ok()
}
