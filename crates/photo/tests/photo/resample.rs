//! Pictures at other sizes, against those that Pillow and OpenCV made (`tests/data/make_resized.py`).

use image::RgbImage;
use scaleproof_photo::{Filter, opencv_cubic, resampled};

use crate::common::home;

/// The script's own picture.
fn picture() -> Vec<u8> {
    let mut state = 1_u64;
    let pixel = |(y, x): (u64, u64)| {
        state = (state * 1_103_515_245 + 12345) % (1 << 31);
        let edge = if (x / 5 + y / 7) % 2 == 1 { 255 } else { 0 };
        [(state >> 23) as u8, edge, (3 * x + 2 * y) as u8]
    };
    let places = (0..37).flat_map(|y| (0..53).map(move |x| (y, x)));
    places.flat_map(pixel).collect()
}

#[test]
fn every_byte_is_pillows() {
    let picture = picture();
    let filters = [
        ("box", Filter::Box),
        ("bilinear", Filter::Bilinear),
        ("bicubic", Filter::Bicubic),
    ];
    for (name, filter) in filters {
        for size in [[20, 11], [53, 12], [7, 37], [106, 74], [61, 30]] {
            let file = home().join(format!("tests/data/resized/{name}_{}x{}.bin", size[0], size[1]));
            let ours = resampled::<3>(&picture, [53, 37], size, filter);
            assert!(ours == std::fs::read(file).unwrap(), "{name} {size:?}");
        }
    }
}

#[test]
fn every_byte_of_cubic_resizing_is_opencvs() {
    let picture = RgbImage::from_raw(53, 37, picture()).unwrap();
    for [width, height] in [[20, 11], [61, 30]] {
        let file = home().join(format!("tests/data/resized/opencv_cubic_{width}x{height}.bin"));
        let ours = opencv_cubic(&picture, [width, height]).into_raw();
        assert!(ours == std::fs::read(file).unwrap(), "{width}×{height}");
    }
}
