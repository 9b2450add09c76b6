//! The paired cluster bootstrap: how far a figure would move if other places and directions had been photographed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::normal;

/// Resamplings of the clusters behind each interval.
pub(crate) const DRAWS: usize = 2000;

/// The seed of every interval: same photos, same interval.
pub(crate) const SEED: u64 = 1;

/// With fewer clusters no exact paired test can reach p < 0.05 (2 / 2⁵ = 0.06), and no resampling knows better.
pub(crate) const FEWEST_CLUSTERS: usize = 6;

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
pub(crate) fn interval_95(clusters: usize, figure: impl Fn(&[u32]) -> f64) -> Option<Interval> {
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
    normal::upper_tail(students_t_95(n - 1.0) * (n / (n - 1.0)).sqrt())
}

/// The t that 95 % of Student's distribution lies within, either side of 0; infinite for degrees of freedom that do not exist.
fn students_t_95(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_table() {
        for (freedom, t) in [
            (1.0, 12.706),
            (2.0, 4.303),
            (5.0, 2.571),
            (15.0, 2.131),
            (40.0, 2.021),
            (95.0, 1.985),
        ] {
            assert!((students_t_95(freedom) - t).abs() < 6e-4, "{freedom}");
        }
    }
}
