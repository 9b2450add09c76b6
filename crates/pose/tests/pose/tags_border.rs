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

/// The picture in the light of a lamp beside it: all of it at the left, `share` of it at the right.
fn lit(image: &GrayImage, share: f64) -> GrayImage {
    let width = f64::from(image.width());
    GrayImage::from_fn(image.width(), image.height(), |x, y| {
        let light = 1.0 - (1.0 - share) * f64::from(x) / width;
        image::Luma([(f64::from(image.get_pixel(x, y).0[0]) * light.powf(1.0 / 2.2)) as u8])
    })
}

#[test]
fn uneven_light_covers_nothing() {
    let (image, corners) = tag();
    for share in [0.8, 0.5, 0.25, 0.15] {
        assert!(is_whole(&lit(&image, share), &corners, 8.0), "{share}");
    }
}

#[test]
fn a_covered_corner_is_noticed_in_uneven_light() {
    for (corner, covered) in [(0, [0, 0]), (1, [54, 0]), (2, [54, 54]), (3, [0, 54])] {
        for level in [0, 110, 220] {
            let (mut image, corners) = tag();
            for (x, y, pixel) in image.enumerate_pixels_mut() {
                let [left, top] = covered;
                if (left..left + 26).contains(&x) && (top..top + 26).contains(&y) {
                    pixel.0[0] = level;
                }
            }
            let image = lit(&image, 0.4);
            // The corner is found 6 px inwards, where the cover ends.
            let mut found = corners;
            let inwards = |v: f64| if v < 40.0 { v + 6.0 } else { v - 6.0 };
            found[corner] = found[corner].map(inwards);
            assert!(!is_whole(&image, &found, 8.0), "corner {corner}, level {level}");
            assert!(
                !is_whole(&image, &corners, 8.0),
                "corner {corner} where it is, level {level}"
            );
        }
    }
}
