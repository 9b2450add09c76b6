//! Functions of each number by itself.

use std::sync::Arc;

use super::{Array, Back, Layer, Sums, owned, vectorised};

#[derive(Debug, Clone, Copy)]
pub(crate) enum Activation {
    Sigmoid,
    /// x·σ(x).
    Silu,
    /// So many times x below 0.
    LeakyRelu(f32),
}

impl Layer for Activation {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let [x] = <[Array; 1]>::try_from(inputs).unwrap_or_default();
        match *self {
            Activation::Sigmoid => each(x, keeps, |x| {
                let s = sigmoid(x);
                (s, s * (1.0 - s))
            }),
            Activation::Silu => each(x, keeps, |x| {
                let s = sigmoid(x);
                (x * s, s * (1.0 + x * (1.0 - s)))
            }),
            // Not `x < 0`, so that what is not a number stays none.
            Activation::LeakyRelu(below) => each(x, keeps, |x| {
                let slope = if x > 0.0 { 1.0 } else { below };
                (slope * x, slope)
            }),
        }
    }
}

/// Keeps the derivative by each number for the backward pass.
#[inline(always)]
fn each<'a>(x: Array, keeps: bool, f: impl Fn(f32) -> (f32, f32)) -> (Array, Option<Back<'a>>) {
    let mut y = owned(x);
    if !keeps {
        vectorised(|| y.iter_mut().for_each(|y| *y = f(*y).0));
        return (Arc::new(y), None);
    }
    let mut slopes = vec![0.0; y.len()];
    let both = y.iter_mut().zip(&mut slopes);
    vectorised(|| both.for_each(|(y, slope)| (*y, *slope) = f(*y)));
    let back = move |mut gradient: Vec<f32>, sums: &mut Sums| {
        vectorised(|| gradient.iter_mut().zip(&slopes).for_each(|(g, slope)| *g *= slope));
        sums.add(0, gradient);
    };
    (Arc::new(y), Some(Box::new(back)))
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + exp(-x))
}

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
