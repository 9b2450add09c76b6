//! Inverse cosine transform (ITU-T T.81, A.3.3) of blocks of coefficients to samples, at full size or reduced.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use super::coefficients::{CoefficientSink, Component};

/// Position in a block, by rows, of each coefficient in zigzag order (T.81, figure A.6).
pub(super) const ZIGZAG: [u8; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7, 14, 21,
    28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54,
    47, 55, 62, 63,
];

/// Transform of each block of a component to `N` samples, row by row. For fewer than 8 × 8, only the lowest frequencies are used, sampled at the
/// centres: as sharp as that number of samples allows.
pub(super) struct Transform<const N: usize> {
    /// Number of samples across a block.
    pub across: usize,
    /// By zigzag place: contribution of one unit of the coefficient to each sample. Empty for whole blocks, which are transformed by rows and then
    /// columns.
    shares: Vec<[f32; N]>,
    /// By zigzag place: contribution of one unit to each sample of a row, before the transform of columns.
    row_shares: [Lanes; 64],
    /// Contribution of one unit of the DC value to each sample.
    mean_share: f32,
    /// Last zigzag place of the frequencies used.
    last: usize,
}

/// Accumulator of a reduced block's samples.
struct SumOfShares<'a, const N: usize> {
    samples: [f32; N],
    shares: &'a [[f32; N]],
}

impl<const N: usize> CoefficientSink for SumOfShares<'_, N> {
    #[inline(always)]
    fn put(&mut self, place: usize, value: i16) {
        let value = f32::from(value);
        for (sample, share) in self.samples.iter_mut().zip(&self.shares[place & 63]) {
            *sample += value * share;
        }
    }
}

/// Accumulator of a whole block's rows, before the transform of columns.
struct RowSums<'a> {
    rows: &'a mut [Lanes; 8],
    shares: &'a [Lanes; 64],
}

impl CoefficientSink for RowSums<'_> {
    #[inline(always)]
    fn put(&mut self, place: usize, value: i16) {
        let row = &mut self.rows[(usize::from(ZIGZAG[place & 63]) / 8) & 7];
        *row = sum(*row, times(self.shares[place & 63], f32::from(value)));
    }
}

impl<const N: usize> Transform<N> {
    /// Creates the transform for a number of samples across and down, whose product is `N`.
    pub(super) fn new([across, down]: [usize; 2], component: &Component) -> Transform<N> {
        let (x, y) = (shares(across), shares(down));
        let places = || ZIGZAG.map(|at| (usize::from(at % 8), usize::from(at / 8)));
        let steps = component.steps.map(f32::from);
        let with_steps = || places().into_iter().zip(steps);
        Transform {
            across,
            shares: match N {
                64 => Vec::new(),
                _ => with_steps()
                    .map(|((u, v), step)| std::array::from_fn(|i| step * x[u][i % across] * y[v][i / across]))
                    .collect(),
            },
            row_shares: std::array::from_fn(|i| times(x[places()[i].0], steps[i])),
            mean_share: steps[0] / 8.0,
            last: places()
                .iter()
                .rposition(|(u, v)| *u < across && *v < down)
                .unwrap_or(0),
        }
    }

    /// Returns the samples of a block, not yet [`to_u8`].
    #[inline(always)]
    pub(super) fn samples(&self, component: &Component, block: usize) -> [f32; N] {
        let mean = f32::from(component.mean(block)) * self.mean_share + MIDDLE;
        if N == 1 {
            return [mean; N];
        }
        if N == 64 {
            return self.whole(component, block, mean);
        }
        let mut samples = SumOfShares {
            samples: [mean; N],
            shares: &self.shares,
        };
        component.each_ac(block, self.last, &mut samples);
        samples.samples
    }

    /// Transforms a whole block: first the rows of its non-zero coefficients, then all columns.
    #[inline(always)]
    fn whole(&self, component: &Component, block: usize, mean: f32) -> [f32; N] {
        let mut rows = [[0.0_f32; 8]; 8];
        // The transform of columns multiplies it by [`C`] of 4.
        rows[0] = [mean / C[4]; 8];
        let mut to = RowSums {
            rows: &mut rows,
            shares: &self.row_shares,
        };
        if !component.each_ac(block, 63, &mut to) {
            return [mean; N];
        }
        columns(&mut rows);
        let mut samples = [0.0; N];
        samples.copy_from_slice(rows.as_flattened());
        samples
    }
}

/// Offset of samples, which are stored as differences from 128. Blocks of one colour often lie at a half, which is rounded up, as by libjpeg:
/// rounding to even would be a bias.
const MIDDLE: f32 = 128.0 + 1.0 / 1024.0;

/// Rounds to the nearest integer, clamped to 0–255. Adding 1.5 · 2²³ leaves an integer in the lowest bits of a float, which takes fewer steps than
/// `as u8`.
#[inline(always)]
pub(super) fn to_u8(value: f32) -> u8 {
    const WHOLE: f32 = 12_582_912.0;
    let whole = (value + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32;
    whole.clamp(0, 255) as u8
}

/// Returns the contribution of one unit of each of a row's eight frequencies to each of `n` samples, 1, 2, 4 or 8.
fn shares(n: usize) -> [[f32; 8]; 8] {
    let mut shares = [[0.0; 8]; 8];
    for (u, shares) in shares.iter_mut().enumerate().take(n) {
        let scale = if u == 0 { FRAC_1_SQRT_2 } else { 1.0 } / 2.0;
        for (i, share) in shares.iter_mut().enumerate().take(n) {
            *share = scale * (PI * u as f32 * (i as f32 + 0.5) / n as f32).cos();
        }
    }
    shares
}

/// cos(k π / 16) / 2.
const C: [f32; 8] = [
    0.5,
    0.490_392_64,
    0.461_939_77,
    0.415_734_8,
    0.353_553_4,
    0.277_785_12,
    0.191_341_72,
    0.097_545_16,
];

/// Transforms eight columns in parallel: even and odd frequencies separately; their sums and differences are the two halves of a column.
#[inline(always)]
fn columns(rows: &mut [Lanes; 8]) {
    let s = *rows;
    let (sum_0, sum_1) = (sum(s[0], s[4]), sum(s[0], times(s[4], -1.0)));
    let (sum_0, sum_1) = (times(sum_0, C[4]), times(sum_1, C[4]));
    let outer = sum(times(s[2], C[2]), times(s[6], C[6]));
    let inner = sum(times(s[2], C[6]), times(s[6], -C[2]));
    let odd =
        |a: f32, b: f32, c: f32, d: f32| sum(sum(times(s[1], a), times(s[3], b)), sum(times(s[5], c), times(s[7], d)));
    let halves = [
        (sum(sum_0, outer), odd(C[1], C[3], C[5], C[7])),
        (sum(sum_1, inner), odd(C[3], -C[7], -C[1], -C[5])),
        (sum(sum_1, times(inner, -1.0)), odd(C[5], -C[1], C[7], C[3])),
        (sum(sum_0, times(outer, -1.0)), odd(C[7], -C[5], C[3], -C[1])),
    ];
    for (i, (even, odd)) in halves.into_iter().enumerate() {
        rows[i] = sum(even, odd);
        rows[7 - i] = sum(even, times(odd, -1.0));
    }
}

/// One number for each of eight columns (SIMD lanes).
type Lanes = [f32; 8];

#[inline(always)]
fn sum(mut a: Lanes, b: Lanes) -> Lanes {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
    a
}

#[inline(always)]
fn times(mut lanes: Lanes, factor: f32) -> Lanes {
    for lane in &mut lanes {
        *lane *= factor;
    }
    lanes
}
