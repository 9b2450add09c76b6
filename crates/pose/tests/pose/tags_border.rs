//! Whether a tag's border is whole.

use image::GrayImage;
use scaleproof_pose::tags::border::is_whole;

/// A dark square from (20, 20) to (60, 60) on white, seen straight on; corners on pixel borders.
fn tag() -> (GrayImage, [[f64; 2]; 4]) {
    let inside = |v: u32| (20..60).contains(&v);
    let image = GrayImage::from_fn(80, 80, |x, y| {
        image::Luma([if inside(x) && inside(y) { 30 } else { 220 }])
    });
    (image, [[19.5, 19.5], [59.5, 19.5], [59.5, 59.5], [19.5, 59.5]])
}

#[test]
fn a_whole_border_passes_in_either_tone() {
    let (mut image, corners) = tag();
    assert!(is_whole(&image, &corners, 8.0));
    image::imageops::invert(&mut image);
    assert!(is_whole(&image, &corners, 8.0));
}

#[test]
fn a_covered_corner_is_noticed() {
    let (mut image, corners) = tag();
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        if x + 60 < y + 32 {
            pixel.0[0] = 220; // everything beyond a slanted line through the bottom-left corner's cells
        }
    }
    assert!(!is_whole(&image, &corners, 8.0));
}

#[test]
fn a_corner_found_in_the_wrong_place_is_noticed() {
    let (image, mut corners) = tag();
    corners[2] = [65.0, 55.0];
    assert!(!is_whole(&image, &corners, 8.0));
}

#[test]
fn a_border_at_the_image_s_edge_does_not_count_as_whole() {
    let (image, _) = tag();
    assert!(!is_whole(
        &image,
        &[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]],
        8.0
    ));
}
