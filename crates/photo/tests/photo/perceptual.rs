use image::codecs::jpeg::JpegEncoder;
use image::{RgbImage, imageops};
use scaleproof_photo::{bits_apart, perceptual_hash};

use crate::common;

fn encoded(image: &RgbImage, quality: u8) -> RgbImage {
    let mut bytes = Vec::new();
    image
        .write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, quality))
        .unwrap();
    image::load_from_memory(&bytes).unwrap().to_rgb8()
}

/// Sixteen stored photos of eight directions and two textures.
#[test]
fn copies_are_near_and_other_views_far() {
    let files = std::fs::read_dir(common::skyline())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let photos = files.filter(|path| path.extension().is_some_and(|e| e == "jpg"));
    let images: Vec<RgbImage> = photos.map(|path| image::open(path).unwrap().to_rgb8()).collect();
    let hashes: Vec<_> = images.iter().map(perceptual_hash).collect();
    let (mut farthest_copy, mut nearest_view) = (0, u32::MAX);
    for (i, image) in images.iter().enumerate() {
        let (width, height) = image.dimensions();
        let small = imageops::resize(image, width * 2 / 5, height * 2 / 5, imageops::FilterType::Triangle);
        let brighter = imageops::brighten(image, 20);
        let moved = RgbImage::from_fn(width, height, |x, y| {
            *image.get_pixel(x.saturating_sub(2), y.saturating_sub(1))
        });
        let copies = [
            encoded(image, 20),
            encoded(image, 60),
            encoded(&small, 80),
            brighter,
            moved,
        ];
        for copy in copies {
            farthest_copy = farthest_copy.max(bits_apart(&perceptual_hash(&copy), &hashes[i]));
        }
        for other in &hashes[..i] {
            nearest_view = nearest_view.min(bits_apart(other, &hashes[i]));
        }
    }
    println!("of 256 bits: copies differ by {farthest_copy} at most, other photos by {nearest_view} at least");
    assert!(
        farthest_copy <= 40 && nearest_view >= 60,
        "{farthest_copy} {nearest_view}"
    );
}
