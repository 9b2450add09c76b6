//! JPEGs of pictures.

use std::path::Path;

use image::RgbImage;

use super::{Budget, Photo};

/// A JPEG of a picture for people to look at; `None` for one wider or higher than 65,535 px, or empty.
pub fn preview_jpeg(picture: &RgbImage, quality: u8) -> Option<Vec<u8>> {
    let [width, height] = [picture.width(), picture.height()].map(u16::try_from);
    let mut jpeg = Vec::new();
    let encoder = jpeg_encoder::Encoder::new(&mut jpeg, quality);
    let encoded = encoder.encode(
        picture.as_raw(),
        width.ok()?,
        height.ok()?,
        jpeg_encoder::ColorType::Rgb,
    );
    encoded.ok().map(|()| jpeg)
}

/// The picture as it comes back from a JPEG of a quality, 1 to 100; `None` where there is no such JPEG.
pub fn as_jpeg(picture: &RgbImage, quality: u8) -> Option<RgbImage> {
    let jpeg = preview_jpeg(picture, quality)?;
    let photo = Photo::from_bytes(Path::new("picture"), jpeg, Budget::FILE).ok()?;
    photo.rgb(1).ok()
}
