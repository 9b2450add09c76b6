//! Colours as eyes and printers see them: CIELAB and CIEDE2000.
//!
//! sRGB as in IEC 61966-2-1, CIELAB under its white D65 (CIE 15), CIEDE2000 after Sharma, Wu & Dalal 2005. The formulas are
//! those of the `palette` crate.

use palette::color_difference::Ciede2000;
use palette::{FromColor, IntoColor, LinSrgb, Srgb};

/// A colour in CIELAB, D65: L* 0 to 100, a* and b* around 0.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lab {
    pub l: f64,
    pub a: f64,
    pub b: f64,
}

impl Lab {
    /// From 8-bit sRGB.
    pub fn of(rgb: [u8; 3]) -> Self {
        let srgb: Srgb<f64> = Srgb::from(rgb).into_format();
        Self::from_palette(palette::Lab::from_color(srgb))
    }

    /// From light in the primaries of sRGB, 1 is white. Values outside 0 to 1 are allowed.
    pub fn of_linear(rgb: [f64; 3]) -> Self {
        Self::from_palette(palette::Lab::from_color(LinSrgb::from(rgb)))
    }

    /// The nearest 8-bit sRGB: channels beyond the screen's range are clipped.
    pub fn rgb(self) -> [u8; 3] {
        Srgb::from(self.srgb()).into_format().into()
    }

    /// sRGB of 0 to 1; channels beyond are clipped.
    pub fn srgb(self) -> [f64; 3] {
        let srgb: Srgb<f64> = self.palette().into_color();
        <[f64; 3]>::from(srgb).map(|v| v.clamp(0.0, 1.0))
    }

    /// CIEDE2000 with all weights 1. Below 1 most people see no difference, 2.3 is just noticeable in CIE 1976's measure.
    pub fn delta_e(self, other: Self) -> f64 {
        self.palette().difference(other.palette())
    }

    fn palette(self) -> palette::Lab<palette::white_point::D65, f64> {
        palette::Lab::new(self.l, self.a, self.b)
    }

    fn from_palette(lab: palette::Lab<palette::white_point::D65, f64>) -> Self {
        Self {
            l: lab.l,
            a: lab.a,
            b: lab.b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let white = Lab::of([255, 255, 255]);
        assert!((white.l - 100.0).abs() < 1e-3 && white.a.abs() < 1e-2 && white.b.abs() < 1e-2);
        // L* of sRGB grey 119 (linear 0.184).
        assert!((Lab::of([119, 119, 119]).l - 50.03).abs() < 0.01);
        for rgb in [[0, 0, 0], [255, 0, 0], [1, 200, 33], [250, 251, 252], [0, 0, 255]] {
            assert_eq!(Lab::of(rgb).rgb(), rgb);
            let light: LinSrgb<f64> = Lab::of(rgb).palette().into_color();
            let again = Lab::of_linear(light.into());
            let off = again.delta_e(Lab::of(rgb));
            assert!(off < 1e-3, "{rgb:?}: {off}");
        }
    }
}
