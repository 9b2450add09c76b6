//! The ring of cells inside a tag's outline.

use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::TagImage;
use scaleproof_pose::tags::inset::behind_the_ring;

#[test]
fn the_cells_behind_the_ring_are_the_code_s_outer_bits() {
    // Tag 0 of tag36h11, 0xd5d628584: rows 110101 011101 011000 101000 010110 000100; a set bit is white.
    let tag = TagImage::new(TagFamily::Tag36h11, 0).unwrap();
    let white = |side| {
        let text: String = behind_the_ring(&tag, side)
            .iter()
            .map(|w| if *w { '1' } else { '0' })
            .collect();
        text[1..7].to_owned()
    };
    assert_eq!(
        [white(0), white(1), white(2), white(3)],
        ["110101", "110000", "001000", "001001"]
    );
}
