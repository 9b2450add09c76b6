//! CIELAB and CIEDE2000.

use palette::{IntoColor, LinSrgb};
use scaleproof_surface::pattern::colour::Lab;

fn palette_lab(Lab { l, a, b }: Lab) -> palette::Lab<palette::white_point::D65, f64> {
    palette::Lab::new(l, a, b)
}

/// Pairs of table 1 of Sharma, Wu & Dalal 2005, chosen for the branches of the formula: hue around 0°, neutral colours,
/// large differences.
#[test]
fn the_difference_is_the_published_one() {
    let table = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [50.0, 3.2592, 0.3350], 1.0000),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ];
    for (a, b, expected) in table {
        let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
        let found = lab(a).delta_e(lab(b));
        assert!((found - expected).abs() < 5e-5, "{a:?} {b:?}: {found}, {expected}");
    }
}

#[test]
fn srgb_and_lab_are_there_and_back() {
    let white = Lab::from_rgb([255, 255, 255]);
    assert!((white.l - 100.0).abs() < 1e-3 && white.a.abs() < 1e-2 && white.b.abs() < 1e-2);
    // L* of sRGB grey 119 (linear 0.184).
    assert!((Lab::from_rgb([119, 119, 119]).l - 50.03).abs() < 0.01);
    for rgb in [[0, 0, 0], [255, 0, 0], [1, 200, 33], [250, 251, 252], [0, 0, 255]] {
        assert_eq!(Lab::from_rgb(rgb).rgb(), rgb);
        let light: LinSrgb<f64> = palette_lab(Lab::from_rgb(rgb)).into_color();
        let again = Lab::from_linear(light.into());
        let off = again.delta_e(Lab::from_rgb(rgb));
        assert!(off < 1e-3, "{rgb:?}: {off}");
    }
}
