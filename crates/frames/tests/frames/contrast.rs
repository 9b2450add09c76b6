use image::{GrayImage, Luma, Rgb, RgbImage};
use scaleproof_frames::photos::contrast::is_in_order;

#[test]
fn lighter_colours_must_look_lighter() {
    let paint = GrayImage::from_fn(4, 4, |x, _| Luma([if x < 2 { 255 } else { 0 }]));
    // Beside the paint all show the same surroundings, which must not count.
    let shown = |level: u8| RgbImage::from_fn(4, 4, |x, _| Rgb([if x < 2 { level } else { 255 }; 3]));
    let (dark, middle, bright) = (shown(30), shown(90), shown(180));
    let [black, grey, white] = [[16; 3], [127; 3], [242; 3]];
    assert!(is_in_order(
        &[(grey, &middle), (black, &dark), (white, &bright)],
        &paint
    ));
    assert!(!is_in_order(
        &[(grey, &middle), (black, &bright), (white, &dark)],
        &paint
    ));
    assert!(!is_in_order(&[(black, &dark), (grey, &dark), (white, &bright)], &paint));
    // Colours that hardly differ may look alike.
    assert!(is_in_order(&[(grey, &middle), ([130; 3], &middle)], &paint));
}
