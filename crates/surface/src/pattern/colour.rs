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
    /// Converts from 8-bit sRGB.
    pub fn from_rgb(rgb: [u8; 3]) -> Self {
        let srgb: Srgb<f64> = Srgb::from(rgb).into_format();
        Self::from_palette(palette::Lab::from_color(srgb))
    }

    /// Converts from light in the primaries of sRGB, 1 is white. Values outside 0 to 1 are allowed.
    pub fn from_linear(rgb: [f64; 3]) -> Self {
        Self::from_palette(palette::Lab::from_color(LinSrgb::from(rgb)))
    }

    /// Returns the nearest 8-bit sRGB: channels beyond the screen's range are clipped.
    pub fn rgb(self) -> [u8; 3] {
        Srgb::from(self.srgb()).into_format().into()
    }

    /// Returns sRGB of 0 to 1; channels beyond are clipped.
    pub fn srgb(self) -> [f64; 3] {
        let srgb: Srgb<f64> = self.palette().into_color();
        <[f64; 3]>::from(srgb).map(|v| v.clamp(0.0, 1.0))
    }

    /// Returns CIEDE2000 with all weights 1. Below 1 most people see no difference, 2.3 is just noticeable in CIE 1976's measure.
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
