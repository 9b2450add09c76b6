//! The numbers that layers compute with: numbers of 32 bits, or of 64 to see what rounding does.

use std::fmt::Debug;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

pub trait Number:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + MulAssign
    + Sum
{
    const ZERO: Self;
    const ONE: Self;
    const LEAST: Self;

    /// The nearest to a number of 64 bits.
    fn of(v: f64) -> Self;

    fn wide(self) -> f64;

    /// self · a + b, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;

    fn exp(self) -> Self;

    fn is_nan(self) -> bool;

    /// The larger of two, and what is not a number where `self` is none.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

macro_rules! number {
    ($kind:ty, $exp:expr) => {
        impl Number for $kind {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const LEAST: Self = <$kind>::NEG_INFINITY;

            #[inline(always)]
            fn of(v: f64) -> Self {
                v as $kind
            }

            #[inline(always)]
            fn wide(self) -> f64 {
                self.into()
            }

            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                <$kind>::mul_add(self, a, b)
            }

            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }

            #[inline(always)]
            fn is_nan(self) -> bool {
                <$kind>::is_nan(self)
            }
        }
    };
}

number!(f32, exp);
number!(f64, f64::exp);

/// e^x to two units of the last place between ±87, and as at these bounds beyond; NaN stays NaN.
///
/// 2^k·e^r with |r| ≤ ln 2 / 2, and the Taylor series of e^r to its seventh power, whose remainder is below 2⁻²⁷.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Added to a small number, it leaves that number's nearest whole one in the last bits.
    const WHOLE: f32 = 12_582_912.0;
    // ln 2 in two parts, the first with so few digits that its product with k is exact (Cody & Waite 1980).
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    let x = x.clamp(-87.0, 87.0);
    let shifted = x.mul_add(std::f32::consts::LOG2_E, WHOLE);
    let k = shifted - WHOLE;
    let r = (-k).mul_add(LN_2[1], (-k).mul_add(LN_2[0], x));
    let inverse_factorials = [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
    let series = inverse_factorials
        .into_iter()
        .fold(1.0 / 5040.0, |sum: f32, c: f32| sum.mul_add(r, c));
    series * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}
