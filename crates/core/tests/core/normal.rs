//! The normal distribution.

use scaleproof_core::statistics::normal::{TWO_SIDED_95, fast_normal_cdf_and_density, upper_tail};

#[test]
fn the_normal_distribution_is_the_tabled_one() {
    for (u, share) in [(0.0, 0.5), (1.0, 0.841344746), (-1.0, 0.158655254), (2.5, 0.993790335)] {
        assert!((upper_tail(-u) - share).abs() < 1e-9);
    }
    assert!((upper_tail(TWO_SIDED_95) - 0.025).abs() < 1e-11);
}

#[test]
fn the_fast_one_is_near_it_everywhere() {
    for step in -2000..=2000 {
        let u = f64::from(step) / 100.0;
        let ([cdf], [density]) = fast_normal_cdf_and_density([u as f32]);
        let exact = (-0.5 * u * u).exp() / std::f64::consts::TAU.sqrt();
        assert!((f64::from(cdf) - upper_tail(-u)).abs() < 4e-7, "{u}: {cdf}");
        assert!((f64::from(density) - exact).abs() < 4e-7, "{u}: {density}");
    }
}
