//! Lines and labels.

use ab_glyph::{Font, FontRef};
use image::{Rgb, RgbImage};
use scaleproof_photo::draw::{LabelAnchor, Lettering, Pen, label, label_size_px, line, polygon};

const PEN: Pen = Pen {
    colour: [255, 0, 0],
    width_px: 3.0,
};
const LETTERS: Lettering = Lettering {
    colour: [255; 3],
    ground: [0, 0, 200],
    size_px: 20.0,
};

fn painted(image: &RgbImage) -> Vec<[u32; 2]> {
    let is_painted = |(_, _, p): &(u32, u32, &Rgb<u8>)| p.0 != [0; 3];
    image
        .enumerate_pixels()
        .filter(is_painted)
        .map(|(x, y, _)| [x, y])
        .collect()
}

#[test]
fn a_line_covers_its_width_and_ends_where_it_should() {
    let mut image = RgbImage::new(60, 40);
    line(&mut image, [10.0, 20.0], [49.0, 20.0], PEN);
    for x in 10..50 {
        let column: Vec<u8> = (18..23).map(|y| image.get_pixel(x, y).0[0]).collect();
        assert_eq!(column, [0, 255, 255, 255, 0], "column {x}");
    }
    assert!(painted(&image).iter().all(|[x, _]| (8..=51).contains(x)));
}

#[test]
fn a_slanted_line_is_as_heavy_as_its_length_and_width_say() {
    let mut image = RgbImage::new(200, 200);
    line(&mut image, [20.0, 30.0], [170.0, 140.0], PEN);
    let ink: f64 = image.pixels().map(|p| f64::from(p.0[0]) / 255.0).sum();
    let expected = 150f64.hypot(110.0) * 3.0 + std::f64::consts::PI * 1.5 * 1.5;
    assert!((ink / expected - 1.0).abs() < 0.02, "{ink} of {expected}");
}

#[test]
fn what_is_far_outside_or_no_number_is_not_drawn_and_takes_no_time() {
    let mut image = RgbImage::new(60, 40);
    line(&mut image, [-1e12, -1e12], [1e12, -1e12], PEN);
    line(&mut image, [f64::NAN, 3.0], [5.0, 5.0], PEN);
    label(&mut image, [f64::INFINITY, 0.0], LabelAnchor::Centre, "text", LETTERS);
    assert!(painted(&image).is_empty());
    line(&mut image, [-1e9, 20.0], [1e9, 20.0], PEN);
    assert_eq!(painted(&image).len(), 3 * 60, "it crosses the whole image");
    polygon(&mut image, &[], PEN);
}

#[test]
fn a_label_stays_inside_and_has_the_size_it_says() {
    for (at, anchor) in [
        ([1e6, 1e6], LabelAnchor::TopLeft),
        ([-50.0, 3.0], LabelAnchor::BottomLeft),
        ([100.0, 50.0], LabelAnchor::Centre),
    ] {
        let mut image = RgbImage::new(200, 100);
        label(&mut image, at, anchor, "azimuth 45°\n± 0.1", LETTERS);
        let [width, height] = label_size_px("azimuth 45°\n± 0.1", 20.0).map(f64::ceil);
        assert_eq!(painted(&image).len() as f64, width * height);
        assert!(image.pixels().any(|p| p.0 == [255; 3]), "there are letters");
    }
}

/// The label's border has the ground's colour: no letter leaves its ground.
#[test]
fn the_letters_lie_within_their_ground() {
    let mut image = RgbImage::new(400, 100);
    label(&mut image, [20.0, 20.0], LabelAnchor::TopLeft, "ÄgjÅ|Wy,", LETTERS);
    let letters: Vec<_> = image.enumerate_pixels().filter(|(_, _, p)| p.0[0] > 60).collect();
    let [width, height] = label_size_px("ÄgjÅ|Wy,", 20.0).map(|v| v.ceil() as u32);
    assert!(letters.len() > 200);
    assert!(
        letters
            .iter()
            .all(|(x, y, _)| (20..20 + width).contains(x) && (20..20 + height).contains(y))
    );
}

#[test]
fn every_printable_letter_has_a_glyph() {
    let font = FontRef::try_from_slice(scaleproof_core::FONT).expect("the font is part of the program");
    for c in (' '..='~').chain('\u{a1}'..='\u{ff}').chain(['…']) {
        assert_ne!(font.glyph_id(c).0, 0, "{c:?}");
    }
    let drawn = |text: &str| {
        let mut image = RgbImage::new(60, 40);
        label(&mut image, [0.0, 0.0], LabelAnchor::TopLeft, text, LETTERS);
        image
    };
    assert_eq!(drawn("漢"), drawn("?"));
}
