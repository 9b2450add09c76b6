//! The light on a colour chart.

use scaleproof_print::colour_chart::light::{ChartLight, Surface};

fn whites(light: impl Fn(f64, f64) -> f64) -> Vec<([f64; 2], [f64; 3])> {
    let places = (0..35).map(|i| [f64::from(i % 5) * 40.0, f64::from(i / 5) * 30.0]);
    // A pattern of ±0.3 % stands for noise.
    let noise = |[x, y]: [f64; 2]| 1.0 + 0.003 * (3.7 * x + 1.9 * y).sin();
    places
        .map(|p| (p, [0.6, 0.5, 0.4].map(|gain| gain * light(p[0], p[1]) * noise(p))))
        .collect()
}

#[test]
fn light_that_falls_off_evenly_is_a_plane() {
    let light = |x: f64, y: f64| (0.002 * x - 0.001 * y).exp();
    let fit = ChartLight::fit(&whites(light), (176.0, 198.0)).unwrap();
    assert_eq!(fit.surface, Surface::Plane);
    let [r, _, b] = fit.at([33.0, 77.0]);
    assert!((r / (0.6 * light(33.0, 77.0)) - 1.0).abs() < 0.003, "{r}");
    assert!((b / (0.4 * light(33.0, 77.0)) - 1.0).abs() < 0.003, "{b}");
}

#[test]
fn vignetting_is_worth_the_larger_surface() {
    let light = |x: f64, y: f64| 1.0 - 1e-5 * ((x - 80.0).powi(2) + (y - 90.0).powi(2));
    let fit = ChartLight::fit(&whites(light), (176.0, 198.0)).unwrap();
    assert_eq!(fit.surface, Surface::Quadratic);
    assert!((fit.at([20.0, 20.0])[1] / (0.5 * light(20.0, 20.0)) - 1.0).abs() < 0.01);
}

#[test]
fn a_white_in_a_shadow_stands_out() {
    let mut shaded = whites(|_, _| 1.0);
    shaded[17].1 = shaded[17].1.map(|v| 0.8 * v);
    let fit = ChartLight::fit(&shaded, (176.0, 198.0)).unwrap();
    let worst = (0..35).max_by(|a, b| fit.off[*a].total_cmp(&fit.off[*b]));
    assert_eq!(worst, Some(17));
    assert!(fit.off[17] > 0.2);
    assert!(ChartLight::fit(&shaded[..7], (176.0, 198.0)).is_none());
}
