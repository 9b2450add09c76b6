//! Photos at their sizes.

use std::path::{Path, PathBuf};

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use scaleproof_photo::{Photo, opencv_linear};

/// A JPEG of 64 × 48 pixels in a file, its left half red.
fn half_red(folder: &Path) -> PathBuf {
    let image = RgbImage::from_fn(64, 48, |x, _| {
        image::Rgb(if x < 32 { [200, 30, 20] } else { [90, 100, 110] })
    });
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 95)
        .encode_image(&image)
        .unwrap();
    let path = folder.join("photo.jpg");
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn a_reduced_picture_shows_the_same_at_each_size() {
    let folder = tempfile::tempdir().unwrap();
    let file = Photo::open(&half_red(folder.path())).unwrap();
    assert_eq!((file.width, file.height), (64, 48));
    for reduction in [1, 2, 4, 8] {
        let image = file.rgb(reduction).unwrap();
        assert_eq!(image.dimensions(), (64 / reduction, 48 / reduction));
        let [left, right] = [8, 56].map(|x| image.get_pixel(x / reduction, 24 / reduction).0);
        let near = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 4);
        assert!(
            near(left, [200, 30, 20]) && near(right, [90, 100, 110]),
            "{left:?} {right:?}"
        );
    }
}

#[test]
fn the_strongest_reduction_that_serves_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let file = Photo::open(&half_red(folder.path())).unwrap();
    let chosen = |least| file.reduction(least);
    assert_eq!(
        [
            chosen([8, 6]),
            chosen([9, 6]),
            chosen([32, 24]),
            chosen([33, 1]),
            chosen([65, 1])
        ],
        [8, 4, 2, 1, 1]
    );
    let png = folder.path().join("photo.png");
    file.rgb(1).unwrap().save(&png).unwrap();
    assert_eq!(Photo::open(&png).unwrap().reduction([1, 1]), 1);
}

#[test]
fn luma_alone_is_that_of_the_colours() {
    let folder = tempfile::tempdir().unwrap();
    let file = Photo::open(&half_red(folder.path())).unwrap();
    let (luma, rgb) = (file.luma().unwrap(), file.rgb(1).unwrap());
    for (stored, rgb) in luma.pixels().zip(rgb.pixels()) {
        // ITU-T T.871, from rounded and clipped colours.
        let [r, g, b] = rgb.0.map(f64::from);
        let luma = 0.299 * r + 0.587 * g + 0.114 * b;
        assert!((f64::from(stored.0[0]) - luma).abs() <= 2.0, "{stored:?} {rgb:?}");
    }
}

/// Of a large photo a network that resizes as OpenCV does looks at few rows: made alone, they make the same picture.
#[test]
fn the_rows_that_are_looked_at_make_the_picture_of_the_whole() {
    let stored = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../captures/skyline/normal_000.jpg"
    ));
    let photo = Photo::open(stored).unwrap();
    let whole = photo.rgb(1).unwrap();
    for size in [[416, 312], [320, 240], [97, 480], [1, 1], [1280, 333]] {
        let alone = photo.rgb_opencv_linear(size).unwrap().unwrap();
        assert!(alone == opencv_linear(&whole, size), "{size:?}");
    }
    // All rows are looked at.
    assert_eq!(photo.rgb_opencv_linear([640, 480]).unwrap(), None);
    assert_eq!(photo.rgb_opencv_linear([1000, 700]).unwrap(), None);
}
