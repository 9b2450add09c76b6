//! What an image shows at the scale of its pixels: how many grey levels, how much noise, how sharp an edge. Tags are sought in an image that is
//! stretched where it is dark, and half as large where its pixels hold noise, or nothing that half as many would not hold.
//!
//! Of 192 spoiled copies of the skyline photos (`benches/pose_speed.sh`), dark ones show 16 of 30 poses as they are and 29 stretched; noisy ones as many at half
//! their size, in a sixth of the time.

use image::GrayImage;

/// Grey levels from the darkest to the brightest 0.5 % of the pixels, below which an image is stretched to all of them: the libraries take
/// differences of 5 to 7 levels for none.
const FEW_LEVELS: f64 = 64.0;

/// Noise per pixel, as a share of those levels, from which half the size shows more. Real photos have up to 0.013.
const MUCH_NOISE: f64 = 0.03;

/// The sharpest 0.1 % of edges change by less than this share of those levels from a pixel to the next where a Gaussian of 2 px or wider blurs them. Sharp
/// photos have 0.33 and more.
const DULL_EDGE: f64 = 0.2;

/// Every so many pixels, across and down, four neighbours are measured.
const STRIDE: usize = 4;

pub(super) struct Legibility {
    /// The levels of the darkest and the brightest 0.5 % of the pixels.
    dark: f64,
    levels: f64,
    noise: f64,
    /// By how much the sharpest 0.1 % of neighbours differ.
    edge: f64,
}

impl Legibility {
    /// By squares of four pixels: their mean, how much their halves differ, and how much their diagonals do, in which edges nearly cancel (as the finest
    /// wavelet, of which the median tells the noise: Donoho & Johnstone 1994, "Ideal spatial adaptation by wavelet shrinkage").
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
            // The median of a normal variable's magnitude is 0.6745 σ; half the difference of the diagonals has a pixel's σ.
            noise: quantile(&diagonals, 0.5) / 2.0 / 0.6745,
            edge: quantile(&edges, 0.999) / 2.0,
        }
    }

    pub(super) fn is_dark(&self) -> bool {
        self.levels < FEW_LEVELS
    }

    /// Whether half the size shows tags better, or as well.
    pub(super) fn is_better_halved(&self) -> bool {
        self.noise > MUCH_NOISE * self.levels || self.is_dark() || self.is_dull()
    }

    /// Whether half the size shows all that there is.
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

/// The least value that is reached by this share of those counted.
fn quantile(counts: &[u32], share: f64) -> f64 {
    let wanted = share * f64::from(counts.iter().sum::<u32>());
    let mut below = 0.0;
    let reached = counts.iter().position(|count| {
        below += f64::from(*count);
        below >= wanted
    });
    reached.unwrap_or_default() as f64
}
