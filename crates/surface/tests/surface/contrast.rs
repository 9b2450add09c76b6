//! Contrast of patterns.

use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::contrast::median_delta_e;

#[test]
fn a_plain_pattern_has_no_contrast_and_a_chessboard_all_there_is() {
    let random = Pattern::random(2, 1).unwrap();
    assert_eq!(median_delta_e(&random.recoloured(|_| [9; 3]).unwrap()), 0.0);
    let top_left = random.cells().get_pixel(0, 0).0;
    let bottom_right = random.cells().get_pixel(1, 1).0;
    let chess = |rgb| {
        if rgb == top_left || rgb == bottom_right {
            [0; 3]
        } else {
            [255; 3]
        }
    };
    let contrast = median_delta_e(&random.recoloured(chess).unwrap());
    assert!((contrast - 100.0).abs() < 0.01, "{contrast}");
}
