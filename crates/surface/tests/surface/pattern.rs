//! Patterns as files.

use image::{DynamicImage, ImageFormat, RgbImage};
use scaleproof_surface::pattern::{Pattern, PatternError};
use std::io::Cursor;

fn load_bytes(bytes: &[u8]) -> Result<Pattern, PatternError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    std::fs::write(&path, bytes).unwrap();
    Pattern::load(&path)
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    image.into().write_to(&mut file, ImageFormat::Png).unwrap();
    file.into_inner()
}

#[test]
fn the_random_sequence_never_changes() {
    let first: Vec<u8> = Pattern::random(16, 1).unwrap().cells().as_raw()[..6].to_vec();
    assert_eq!(first, [0xe6, 0x0b, 0xa7, 0x33, 0xee, 0xf3]);
    assert_ne!(Pattern::random(16, 1).unwrap(), Pattern::random(16, 2).unwrap());
}

#[test]
fn a_written_pattern_reads_back_with_the_same_hash() {
    let made = Pattern::random(5, 9).unwrap();
    assert_eq!(load_bytes(&made.to_png().unwrap()).unwrap(), made);
}

#[test]
fn opaque_alpha_is_fine_and_see_through_pixels_are_refused() {
    let mut image = image::RgbaImage::from_pixel(3, 2, image::Rgba([10, 20, 30, 255]));
    assert_eq!(
        load_bytes(&png(image.clone())).unwrap().cells().get_pixel(2, 1).0,
        [10, 20, 30]
    );
    image.put_pixel(2, 1, image::Rgba([10, 20, 30, 254]));
    let error = load_bytes(&png(image)).unwrap_err();
    assert!(
        matches!(error, PatternError::Transparent { column: 2, row: 1, .. }),
        "{error}"
    );
}

#[test]
fn what_is_no_pattern_is_refused() {
    assert!(matches!(load_bytes(b"a text file"), Err(PatternError::NotPng { .. })));
    assert!(matches!(
        load_bytes(&png(RgbImage::new(513, 2))),
        Err(PatternError::TooManyCells { .. })
    ));
    assert!(load_bytes(&png(RgbImage::new(512, 512))).is_ok());
    let whole = png(RgbImage::new(64, 64));
    assert!(matches!(
        load_bytes(&whole[..whole.len() - 20]),
        Err(PatternError::Damaged { .. })
    ));
    assert!(matches!(
        Pattern::random(0, 1),
        Err(PatternError::BadCellCount { cells: 0 })
    ));
}
