//! Legibility of an image at the scale of its pixels: number of grey levels, noise, sharpness of edges. Dark images are stretched before the search,
//! and noisy or dull ones searched at half the size.
//!
//! Of 192 spoiled copies of the skyline photos (`benches/pose_speed.sh`), dark ones give 16 of 30 poses as they are and 29 stretched; noisy ones as
//! many at half their size, in a sixth of the time.

use image::GrayImage;

/// Range of grey levels between the darkest and the brightest 0.5 % of the pixels below which an image is stretched: the libraries ignore differences
/// of 5 to 7 levels.
const FEW_LEVELS: f64 = 64.0;

/// Noise per pixel, as a share of that range, from which half the size shows more. Real photos have up to 0.013.
const MUCH_NOISE: f64 = 0.03;

/// Difference between neighbouring pixels of the sharpest 0.1 % of edges, as a share of that range, below which an image is dull, as by a Gaussian of
/// 2 px or wider. Sharp photos have 0.33 and more.
const DULL_EDGE: f64 = 0.2;

/// Step, across and down, between measured squares of four pixels.
const STRIDE: usize = 4;

pub(super) struct Legibility {
    /// Level below which the darkest 0.5 % of the pixels lie; `levels` is the range from there to the brightest 0.5 %.
    dark: f64,
    levels: f64,
    noise: f64,
    /// Difference between neighbours at the sharpest 0.1 % of edges.
    edge: f64,
}

impl Legibility {
    /// Measures an image by squares of four pixels: their means, the differences of their halves, and those of their diagonals, in which edges nearly
    /// cancel (the finest wavelet, whose median gives the noise: Donoho & Johnstone 1994, "Ideal spatial adaptation by wavelet shrinkage").
    pub(super) fn new(grey: &GrayImage) -> Legibility {
        let (width, [mut means, mut edges, mut diagonals]) = (grey.width() as usize, [[0u32; 511]; 3]);
        let rows: Vec<&[u8]> = grey.as_raw().chunks_exact(width.max(1)).collect();
        for pair in rows.chunks_exact(2).step_by(STRIDE / 2) {
            for x in (0..width.saturating_sub(1)).step_by(STRIDE) {
                let [a, b, c, d] = [pair[0][x], pair[0][x + 1], pair[1][x], pair[1][x + 1]].map(i32::from);
                means[((a + b + c + d) / 2) as usize] += 1;
                edges[(a + c - b - d).abs().max((a + b - c - d).abs()) as usize] += 1;
                diagonals[(a - b - c + d).unsigned_abs() as usize] += 1;
            }
        }
        let [dark, bright] = [0.005, 0.995].map(|share| quantile(&means, share) / 2.0);
        Legibility {
            dark,
            levels: (bright - dark).max(1.0),
            // The median magnitude of a normal variable is 0.6745 σ; half the difference of the diagonals has a pixel's σ.
            noise: quantile(&diagonals, 0.5) / 2.0 / 0.6745,
            edge: quantile(&edges, 0.999) / 2.0,
        }
    }

    pub(super) fn is_dark(&self) -> bool {
        self.levels < FEW_LEVELS
    }

    /// Returns true if half the size shows tags better, or as well.
    pub(super) fn is_better_halved(&self) -> bool {
        self.noise > MUCH_NOISE * self.levels || self.is_dark() || self.is_dull()
    }

    /// Returns true if half the size loses no detail.
    pub(super) fn is_dull(&self) -> bool {
        self.edge < DULL_EDGE * self.levels
    }

    pub(super) fn stretched(&self, grey: &GrayImage) -> GrayImage {
        let level = |v: usize| ((v as f64 - self.dark) * 255.0 / self.levels).round().clamp(0.0, 255.0) as u8;
        let table: [u8; 256] = std::array::from_fn(level);
        let mut stretched = grey.clone();
        stretched.iter_mut().for_each(|v| *v = table[usize::from(*v)]);
        stretched
    }
}

/// Returns the least value at which the cumulative share of the counts reaches `share`.
fn quantile(counts: &[u32], share: f64) -> f64 {
    let wanted = share * f64::from(counts.iter().sum::<u32>());
    let mut below = 0.0;
    let reached = counts.iter().position(|count| {
        below += f64::from(*count);
        below >= wanted
    });
    reached.unwrap_or_default() as f64
}
