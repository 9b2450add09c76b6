//! Blocks of coefficients into samples: the inverse cosine transform (ITU-T T.81, A.3.3), whole or of fewer samples.

use std::f32::consts::{FRAC_1_SQRT_2, PI};

use super::coefficients::{Component, Take};

/// Where in a block, by rows, the coefficient of each place in the order of frequencies lies (T.81, figure A.6).
pub(super) const ZIGZAG: [u8; 64] = [
    0, 1, 8, 16, 9, 2, 3, 10, 17, 24, 32, 25, 18, 11, 4, 5, 12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6, 7, 14, 21,
    28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54,
    47, 55, 62, 63,
];

/// Makes `N` samples of each block of a component, its rows one after the other. Fewer than 8 × 8 are made of the lowest frequencies alone, taken at
/// the middle of each sample: as sharp as so few samples can be.
pub(super) struct Transform<const N: usize> {
    /// Samples across a block.
    pub across: usize,
    /// By places: what one unit of the coefficient adds to each sample. Empty for whole blocks, whose rows and columns are taken one after the
    /// other.
    shares: Vec<[f32; N]>,
    /// By places: what one unit adds to each sample of a row, columns not yet transformed.
    row_shares: [Lanes; 64],
    /// What one unit of the mean adds to each sample.
    mean_share: f32,
    /// The last place of the frequencies that count.
    last: usize,
}

/// Samples of the lowest frequencies.
struct SumOfShares<'a, const N: usize> {
    samples: [f32; N],
    shares: &'a [[f32; N]],
}

impl<const N: usize> Take for SumOfShares<'_, N> {
    #[inline(always)]
    fn take(&mut self, place: usize, value: i16) {
        let value = f32::from(value);
        for (sample, share) in self.samples.iter_mut().zip(&self.shares[place & 63]) {
            *sample += value * share;
        }
    }
}

/// The rows of a whole block, columns not yet transformed.
struct RowSums<'a> {
    rows: &'a mut [Lanes; 8],
    shares: &'a [Lanes; 64],
}

impl Take for RowSums<'_> {
    #[inline(always)]
    fn take(&mut self, place: usize, value: i16) {
        let row = &mut self.rows[(usize::from(ZIGZAG[place & 63]) / 8) & 7];
        *row = sum(*row, times(self.shares[place & 63], f32::from(value)));
    }
}

impl<const N: usize> Transform<N> {
    /// For so many samples across and down, whose product is `N`.
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

    /// The samples of a block, not yet [`rounded`].
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
        component.each_other(block, self.last, &mut samples);
        samples.samples
    }

    /// Rows first, of those coefficients that are not zero; then all columns.
    #[inline(always)]
    fn whole(&self, component: &Component, block: usize, mean: f32) -> [f32; N] {
        let mut rows = [[0.0_f32; 8]; 8];
        // The columns multiply it by [`C`] of 4.
        rows[0] = [mean / C[4]; 8];
        let mut to = RowSums {
            rows: &mut rows,
            shares: &self.row_shares,
        };
        if !component.each_other(block, 63, &mut to) {
            return [mean; N];
        }
        columns(&mut rows);
        let mut samples = [0.0; N];
        samples.copy_from_slice(rows.as_flattened());
        samples
    }
}

/// Samples are stored as differences from 128. Blocks of one colour often lie at a half, which is rounded up, as libjpeg does: to the even
/// neighbour it would be a bias.
const MIDDLE: f32 = 128.0 + 1.0 / 1024.0;

/// To the next whole number of 0 to 255. Adding 1.5 · 2²³ leaves a whole number in the lowest bits of a float, which takes fewer steps than
/// `as u8`.
#[inline(always)]
pub(super) fn rounded(value: f32) -> u8 {
    const WHOLE: f32 = 12_582_912.0;
    let whole = (value + WHOLE).to_bits() as i32 - WHOLE.to_bits() as i32;
    whole.clamp(0, 255) as u8
}

/// What one unit of each of the eight frequencies of a row adds to each of `n` samples, 1, 2, 4 or 8.
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

/// The transform of eight columns side by side: even and odd frequencies apart, whose sums and differences are the two halves of a column.
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

/// One number for each of eight columns.
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
