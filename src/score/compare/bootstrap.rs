//! The paired cluster bootstrap: how far a figure would move if other places and directions had been photographed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::student;

/// Resamplings of the clusters behind each interval.
pub const DRAWS: usize = 2000;

/// The seed of every interval: same photos, same interval.
pub const SEED: u64 = 1;

/// With fewer clusters no exact paired test can reach p < 0.05 (2 / 2⁵ = 0.06), and no resampling knows better.
pub const FEWEST_CLUSTERS: usize = 6;

/// A 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// 95 % interval of a figure over `clusters` clusters.
///
/// Clusters are drawn with replacement, and `figure` gets how often each was drawn: a cluster drawn twice counts twice (leaving
/// duplicates out makes the interval a quarter too narrow). The percentiles are widened for few clusters, as by
/// Hesterberg, "What Teachers Should Know About the Bootstrap", The American Statistician 69 (2015), "expanded percentile interval".
///
/// `None` when the clusters are fewer than six, or when every draw gave the same figure: then the data say nothing
/// about how far off it is.
pub fn interval_95(clusters: usize, figure: impl Fn(&[u32]) -> f64) -> Option<Interval> {
    if clusters < FEWEST_CLUSTERS {
        return None;
    }
    let mut rng = Pcg64Mcg::seed_from_u64(SEED);
    let mut drawn = vec![0; clusters];
    let mut figures: Vec<f64> = Vec::with_capacity(DRAWS);
    for _ in 0..DRAWS {
        drawn.fill(0);
        for _ in 0..clusters {
            drawn[rng.random_range(0..clusters)] += 1;
        }
        figures.push(figure(&drawn));
    }
    figures.sort_by(f64::total_cmp);
    let tail = expanded_tail(clusters) * DRAWS as f64;
    // The outer of the two draws next to the percentile.
    let from_end = (tail.floor() as usize).saturating_sub(1);
    let (low, high) = (figures[from_end], figures[DRAWS - 1 - from_end]);
    let alike = figures[DRAWS - 1] - figures[0] < 1e-12;
    (!alike).then_some(Interval { low, high })
}

/// The share of draws beyond each end: that of a normal beyond t·√(n/(n−1)), with Student's t for n − 1 degrees of freedom.
fn expanded_tail(clusters: usize) -> f64 {
    let n = clusters as f64;
    let z = student::two_sided_95(clusters - 1) * (n / (n - 1.0)).sqrt();
    libm::erfc(z / std::f64::consts::SQRT_2) / 2.0
}
