//! What tags look like.

use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::TagImage;

#[test]
fn the_image_is_the_published_one() {
    // Tag 0 of tag36h11: code 0xd5d628584, first bit top left, 1 is white (Olson 2011; April Robotics' tag36_11_00000.png).
    let image = TagImage::new(TagFamily::Tag36h11, 0).unwrap();
    assert_eq!((image.modules().side(), image.border_modules()), (10, 8));
    let bits = image.modules().cropped(2);
    for i in 0..36 {
        let white = 0xd_5d62_8584_u64 >> (35 - i) & 1 == 1;
        assert_eq!(bits.is_black(i / 6, i % 6), !white, "bit {i}");
    }
}

#[test]
fn every_family_has_white_around_it_and_refuses_an_id_too_many() {
    for (family, name) in TagFamily::ALL {
        let image = TagImage::new(family, family.count() - 1).unwrap();
        let side = image.modules().side();
        assert_eq!(image.width_mm(1.0), family.width_with_white(), "{name}");
        for i in 0..side {
            for (row, column) in [(0, i), (side - 1, i), (i, 0), (i, side - 1)] {
                assert!(!image.modules().is_black(row, column), "{name}");
            }
        }
        assert_eq!(TagImage::new(family, family.count()), None, "{name}");
    }
}
