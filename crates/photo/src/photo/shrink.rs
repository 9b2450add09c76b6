//! Pictures made smaller and encoded, to be shown.

use fast_image_resize as fir;
use fir::images::{TypedImage, TypedImageRef};
use fir::pixels::U8x3;
use image::RgbImage;

/// The picture at another size: bilinear, each pixel the mean of all that it stands for. An empty picture stays.
pub fn shrunk(picture: &RgbImage, size: [u32; 2]) -> RgbImage {
    resized(picture, size, fir::FilterType::Bilinear)
}

/// The picture at another size, each pixel the plain mean of those whose centres are in it. An empty picture stays.
pub fn boxed(picture: &RgbImage, size: [u32; 2]) -> RgbImage {
    resized(picture, size, fir::FilterType::Box)
}

fn resized(picture: &RgbImage, [width, height]: [u32; 2], filter: fir::FilterType) -> RgbImage {
    let resized = || {
        let from = TypedImageRef::<U8x3>::from_buffer(picture.width(), picture.height(), picture.as_raw()).ok()?;
        let mut pixels = vec![0; 3 * width as usize * height as usize];
        let mut to = TypedImage::<U8x3>::from_buffer(width, height, &mut pixels).ok()?;
        let options = fir::ResizeOptions::new().resize_alg(fir::ResizeAlg::Convolution(filter));
        // By the type of its pixels: `resize` would compile the loops for every type there is.
        fir::Resizer::new().resize_typed(&from, &mut to, &options).ok()?;
        RgbImage::from_raw(width, height, pixels)
    };
    if picture.dimensions() == (width, height) {
        picture.clone()
    } else {
        resized().unwrap_or_else(|| picture.clone())
    }
}

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
