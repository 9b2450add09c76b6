//! sRGB and linear light.

use scaleproof_surface::pattern::light::{decode, decode_derivative, linear_of, rgb_of};

#[test]
fn the_curve_is_srgb_there_and_back() {
    // L* 50 grey and the standard's own junction.
    assert!((decode(119.0 / 255.0) - 0.1845).abs() < 1e-4);
    for v in 0..=255_u8 {
        assert_eq!(rgb_of(linear_of([v; 3])), [v; 3]);
        let x = f64::from(v) / 255.0;
        let step = 1e-6;
        let derivative = (decode(x + step) - decode(x - step)) / (2.0 * step);
        assert!((derivative - decode_derivative(x)).abs() < 1e-4, "{v}");
    }
    assert_eq!(rgb_of([-1.0, 2.0, 0.0]), [0, 255, 0]);
}
