//! Resizing as by Pillow's `Image.resize`, byte for byte, so that networks trained with it get the same input.
//!
//! A pixel of the smaller picture is a weighted mean of those within the filter's support, which grows with the reduction. Rows and columns are
//! resized one after the other, with bytes in between; weights are multiples of 2⁻²².

/// Weight of a neighbour by its distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// Constant weight.
    Box,
    /// Weight that falls linearly to 0 at the next pixel.
    Bilinear,
    /// Keys' cubic with a = -1/2, which is Catmull and Rom's.
    Bicubic,
}

impl Filter {
    /// Returns the filter's radius in pixels of the smaller picture.
    fn reach(self) -> f64 {
        match self {
            Filter::Box => 0.5,
            Filter::Bilinear => 1.0,
            Filter::Bicubic => 2.0,
        }
    }

    fn weight(self, distance: f64) -> f64 {
        let x = distance.abs();
        match self {
            // Of two pixels at the border of a box only one belongs to it.
            Filter::Box => f64::from(distance > -0.5 && distance <= 0.5),
            Filter::Bilinear => (1.0 - x).max(0.0),
            Filter::Bicubic if x < 1.0 => (1.5 * x - 2.5) * x * x + 1.0,
            Filter::Bicubic if x < 2.0 => ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0,
            Filter::Bicubic => 0.0,
        }
    }
}

/// Resizes the bytes of a picture of `N` channels; neither size has a side of 0.
pub fn resampled<const N: usize>(source: &[u8], from: [u32; 2], to: [u32; 2], filter: Filter) -> Vec<u8> {
    let ([columns, rows], [width, height]) = (from.map(|side| side as usize), to.map(|side| side as usize));
    let (across, down) = (taps(columns, width, filter), taps(rows, height, filter));
    // Pillow 13 resizes columns first if they shrink more than twice as much as the rows (found by trying 697 sizes); earlier versions never do.
    if rows > height && rows + 2 * width > height + 2 * columns {
        let flattened = columns_resized(source, N * columns, &down);
        return rows_resized::<N>(&flattened, columns, &across);
    }
    columns_resized(&rows_resized::<N>(source, columns, &across), N * width, &down)
}

const BITS: u32 = 22;
const HALF: i32 = 1 << (BITS - 1);

/// Source pixels of a pixel: the first index, and the weights from there on.
struct Tap {
    first: usize,
    weights: Vec<i32>,
}

fn taps(from: usize, to: usize, filter: Filter) -> Vec<Tap> {
    let scale = from as f64 / to as f64;
    let spread = scale.max(1.0);
    let tap = |at: usize| {
        let centre = (at as f64 + 0.5) * scale;
        let reach = filter.reach() * spread;
        // Truncated, so that positions left of the border become 0.
        let first = (centre - reach + 0.5) as usize;
        let end = ((centre + reach + 0.5) as usize).min(from);
        let weight = |i: usize| filter.weight((i as f64 - centre + 0.5) * (1.0 / spread));
        let weights: Vec<f64> = (first..end).map(weight).collect();
        let share = 1.0 / weights.iter().sum::<f64>();
        let whole = |w: f64| (w * share * f64::from(1 << BITS)).round() as i32;
        Tap {
            first,
            weights: weights.into_iter().map(whole).collect(),
        }
    };
    (0..to).map(tap).collect()
}

#[inline(always)]
fn byte(sum: i32) -> u8 {
    (sum >> BITS).clamp(0, 255) as u8
}

/// Number of SIMD lanes for a pixel's channels, which are three at most.
const LANES: usize = 4;

scaleproof_core::by_avx2! {
    fn rows_resized[const N: usize](source: &[u8], columns: usize, taps: &[Tap]) -> Vec<u8> {
        let rows = source.len() / (N * columns);
        let mut out = vec![0; N * taps.len() * rows];
        let mut pixels = vec![[0_i32; LANES]; columns];
        // All lanes are kept until a row is done: otherwise the compiler uses scalars instead of vectors.
        let mut made = vec![[0_u8; LANES]; taps.len()];
        for (row, out) in source.chunks_exact(N * columns).zip(out.chunks_exact_mut(N * taps.len())) {
            for (wide, pixel) in pixels.iter_mut().zip(row.as_chunks::<N>().0) {
                for channel in 0..N {
                    wide[channel] = i32::from(pixel[channel]);
                }
            }
            for (made, Tap { first, weights }) in made.iter_mut().zip(taps) {
                let mut sums = [HALF; LANES];
                for (pixel, weight) in pixels[*first..].iter().zip(weights) {
                    for lane in 0..LANES {
                        sums[lane] += weight * pixel[lane];
                    }
                }
                *made = sums.map(byte);
            }
            for (out, made) in out.as_chunks_mut::<N>().0.iter_mut().zip(&made) {
                out.copy_from_slice(&made[..N]);
            }
        }
        out
    }
}

scaleproof_core::by_avx2! {
    fn columns_resized(source: &[u8], stride: usize, taps: &[Tap]) -> Vec<u8> {
        let mut out = Vec::with_capacity(stride * taps.len());
        let mut sums = vec![0; stride];
        for Tap { first, weights } in taps {
            sums.fill(HALF);
            for (row, weight) in source[first * stride..].chunks_exact(stride).zip(weights) {
                for (sum, value) in sums.iter_mut().zip(row) {
                    *sum += weight * i32::from(*value);
                }
            }
            out.extend(sums.iter().map(|sum| byte(*sum)));
        }
        out
    }
}
