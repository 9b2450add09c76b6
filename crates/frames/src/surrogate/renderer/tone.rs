//! The tone curve of an image.

use crate::light;

/// Tone curve: values are sRGB's curve with an exponent: light = decode(x)^`power`. 1 is exactly sRGB, as frames are rendered. A fitted
/// exponent also takes up some of the light that goes to and fro between the paint's parts, so it is no measurement of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    pub power: f64,
}

impl Tone {
    /// Range of fitted exponents.
    pub const POWERS: std::ops::RangeInclusive<f64> = 0.5..=2.0;
    pub const SRGB: Self = Self { power: 1.0 };

    /// Returns the light of an image's value.
    pub fn light(self, x: f64) -> f64 {
        light::decode(x).powf(self.power)
    }

    /// Returns the image's value of light.
    pub fn value(self, light: f64) -> f64 {
        light::encode(light.clamp(0.0, 1.0).powf(1.0 / self.power))
    }

    /// Returns the derivative of [`Tone::value`]; 0 where it clips.
    pub fn value_derivative(self, light: f64) -> f64 {
        if !(light > 0.0 && light < 1.0) {
            return 0.0;
        }
        let inner = light.powf(1.0 / self.power);
        let inner_derivative = inner / (light * self.power);
        inner_derivative / light::decode_derivative(light::encode(inner))
    }
}

/// Minimises a function with one valley in a range (golden section, Kiefer 1953).
pub(super) fn minimise(range: std::ops::RangeInclusive<f64>, of: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = range.into_inner();
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    while high - low > 1e-3 {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = of(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = of(b);
        }
    }
    0.5 * (low + high)
}
