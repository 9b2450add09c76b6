//! Luma where somebody looks is that of the whole.

use std::path::Path;

use image::GrayImage;
use scaleproof_photo::{Budget, Luma, Photo};

#[test]
fn reducing_takes_means_and_leaves_the_rest_out() {
    let image = GrayImage::from_fn(7, 5, |x, y| image::Luma([(10 * x + y) as u8]));
    let small = image.reduced(2);
    assert_eq!(small.dimensions(), (3, 2));
    assert_eq!(small.as_raw(), &[6, 26, 46, 8, 28, 48]); // 5.5 and so on, rounded up
}

/// By every factor: rounded means, half upwards.
#[test]
fn reducing_by_any_factor_takes_means() {
    let image = GrayImage::from_fn(97, 61, |x, y| {
        image::Luma([((x * x * 7 + 31 * y * x + 250) % 256) as u8])
    });
    for factor in 1..=9 {
        let mean = |x: u32, y: u32| {
            let all = (0..factor * factor).map(|k| (factor * x + k % factor, factor * y + k / factor));
            let sum: u32 = all.map(|(x, y)| u32::from(image.get_pixel(x, y).0[0])).sum();
            image::Luma([(f64::from(sum) / f64::from(factor * factor)).round() as u8])
        };
        let expected = GrayImage::from_fn(97 / factor, 61 / factor, mean);
        assert_eq!(*image.reduced(factor), expected, "{factor}");
    }
    let white = GrayImage::from_pixel(64, 64, image::Luma([255]));
    assert!((2..=8).all(|factor| white.reduced(factor).iter().all(|level| *level == 255)));
}

/// However it is turned, and wherever the part begins: the same bytes as of the whole.
#[test]
fn a_part_of_a_jpeg_is_what_the_whole_has_there() {
    let texture = GrayImage::from_fn(83, 61, |x, y| image::Luma([((x * x + 3 * x * y + 7 * y) % 251) as u8]));
    let bytes = jpeg(&texture, 90);
    for orientation in 1..=8 {
        // An EXIF segment behind the start of the image: a TIFF structure with the orientation alone.
        let exif = [
            &b"\xFF\xE1\0\x22Exif\0\0MM\0\x2A\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"[..],
            &[orientation, 0, 0, 0, 0, 0, 0],
        ];
        let turned = [&bytes[..2], &exif.concat(), &bytes[2..]].concat();
        let photo = Photo::from_bytes(Path::new("turned.jpg"), turned, Budget::FILE).unwrap();
        assert_eq!(photo.width == 61, orientation > 4);
        let whole = photo.luma().unwrap();
        for (start, size) in [
            ([0, 0], [1, 1]),
            ([3, 8], [17, 23]),
            ([40, 40], [20, 20]),
            ([8, 0], [50, 60]),
        ] {
            let part = photo.luma_where_seen().unwrap().part(start, size);
            assert_eq!(part, whole.part(start, size), "{orientation} {start:?}");
        }
    }
}

/// A JPEG of a grey image.
fn jpeg(image: &GrayImage, quality: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, quality);
    encoder.encode_image(image).unwrap();
    bytes
}

#[test]
fn a_jpeg_is_reduced_as_its_pixels_are() {
    let smooth = GrayImage::from_fn(96, 64, |x, y| image::Luma([(60 + x + y) as u8]));
    let photo = Photo::from_bytes(Path::new("smooth.jpg"), jpeg(&smooth, 95), Budget::FILE).unwrap();
    for factor in [2, 3, 4, 8] {
        let luma = photo.luma_where_seen().unwrap();
        let (cheap, exact) = (
            luma.reduced(factor).into_owned(),
            luma.whole().reduced(factor).into_owned(),
        );
        assert_eq!(cheap.dimensions(), exact.dimensions());
        let differ = cheap.as_raw().iter().zip(exact.as_raw());
        assert!(differ.map(|(a, b)| a.abs_diff(*b)).all(|d| d <= 1), "1/{factor}");
    }
}
