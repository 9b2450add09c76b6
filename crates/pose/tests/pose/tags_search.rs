//! What a library is shown of an image.

use image::GrayImage;
use scaleproof_photo::Luma;
use scaleproof_pose::tags::library_reduction;

#[test]
fn a_library_sees_nothing_tiny_and_nothing_huge() {
    let seen_by_library = |width: u32, height: u32| {
        let grey = GrayImage::new(width, height);
        library_reduction(&grey).map(|factor| grey.reduced(factor).dimensions())
    };
    assert_eq!(seen_by_library(1, 1), None);
    assert_eq!(seen_by_library(4000, 15), None);
    assert_eq!(seen_by_library(16, 16), Some((16, 16)));
    assert_eq!(seen_by_library(6000, 4000), Some((6000, 4000)));
    assert_eq!(seen_by_library(12_000, 9_000), Some((6000, 4500)));
    assert_eq!(seen_by_library(3_000_000, 20), None, "nothing is left of it");
    assert_eq!(
        seen_by_library(65_535, 64),
        Some((21_845, 21)),
        "longer sides end the C library"
    );
}
