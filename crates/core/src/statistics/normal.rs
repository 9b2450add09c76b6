//! The standard normal distribution.

use rand::{Rng, RngExt};
use statrs::function::erf::erfc;

/// 95 % of the distribution lies within this distance of 0.
pub const TWO_SIDED_95: f64 = 1.959963984540054;

/// Draws a standard normal value (Box & Muller 1958).
pub fn draw(rng: &mut impl Rng) -> f64 {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Returns the probability that a standard normal variable is above `z`.
pub fn upper_tail(z: f64) -> f64 {
    erfc(z / std::f64::consts::SQRT_2) / 2.0
}

/// Returns the probability that a normal variable lies between two values.
pub fn between(from: f64, to: f64, mean: f64, sigma: f64) -> f64 {
    upper_tail((from - mean) / sigma) - upper_tail((to - mean) / sigma)
}

/// Returns the standard normal distribution Φ(u) and its density, for fits that need both of every pixel: within 4e-7 (Abramowitz & Stegun 1964, 26.2.17).
#[inline(always)]
pub fn fast_normal_cdf_and_density<const N: usize>(u: [f32; N]) -> ([f32; N], [f32; N]) {
    const AT_0: f32 = 0.398_942_3; // 1 / √(2π)
    let (mut cdf, mut density) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        let far = u[i].abs();
        let d = AT_0 * power_of_two(far * far * (-0.5 * std::f32::consts::LOG2_E));
        let t = 1.0 / (1.0 + 0.231_641_9 * far);
        let inner = 1.781_477_9 + t * (-1.821_255_9 + t * 1.330_274_4);
        let tail = d * t * (0.319_381_54 + t * (-0.356_563_78 + t * inner));
        (cdf[i], density[i]) = (if u[i] < 0.0 { tail } else { 1.0 - tail }, d);
    }
    (cdf, density)
}

/// 2ˣ for x ≤ 0 within 3e-7 of it, and less than 1e-37 below −125: a whole power by the exponent's bits, the rest by its Taylor series.
#[inline(always)]
fn power_of_two(x: f32) -> f32 {
    /// Added to a number, it leaves the nearest whole one in the lowest bits.
    const WHOLE: f32 = 12_582_912.0;
    let x = if x > -125.0 { x } else { -125.0 };
    let shifted = x + WHOLE;
    let whole = (shifted.to_bits() as i32).wrapping_sub(WHOLE.to_bits() as i32);
    let rest = (x - (shifted - WHOLE)) * std::f32::consts::LN_2;
    let last = 1.0 / 24.0 + rest * (1.0 / 120.0 + rest * (1.0 / 720.0));
    let series = 1.0 + rest * (1.0 + rest * (0.5 + rest * (1.0 / 6.0 + rest * last)));
    series * f32::from_bits(((whole + 127) << 23) as u32)
}
