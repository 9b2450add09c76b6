//! The exponential function of the layers.

use scaleproof_gradients::layers::number::exp;

#[test]
fn exp_is_that_of_64_bits() {
    let worst = (-8700..=8700)
        .map(|i| i as f32 / 100.0 + 0.003)
        .filter(|x| x.abs() <= 87.0);
    let worst = worst
        .map(|x| (f64::from(exp(x)) / f64::from(x).exp() - 1.0).abs())
        .fold(0.0, f64::max);
    assert!(worst < 2.0 * f64::from(f32::EPSILON), "{worst}");
    assert!(exp(f32::NAN).is_nan());
    assert!(exp(-1e9) < 1e-37 && exp(1e9) > 1e37);
}
