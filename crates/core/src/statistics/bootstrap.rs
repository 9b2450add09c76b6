//! The paired cluster bootstrap: how far a figure would move if other places and directions had been photographed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::normal;

/// Resamplings of the clusters behind each interval.
pub const DRAWS: usize = 2000;

/// The seed of every interval: same photos, same interval.
pub const SEED: u64 = 1;

/// Least number of clusters with which an exact paired test can reach p < 0.05 (2 / 2⁵ = 0.06); resampling of fewer knows no better.
pub const FEWEST_CLUSTERS: usize = 6;

/// Figures that differ by less are the same.
pub const ALIKE: f64 = 1e-12;

/// A 95 % interval, from `low` to `high`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// Computes 95 % intervals of figures over `clusters` clusters, all from the same draws.
///
/// Clusters are drawn with replacement, and `figures_of` gets how often each was drawn: a cluster drawn twice counts twice (leaving
/// duplicates out makes the interval a quarter too narrow). The percentiles are widened for few clusters, as by
/// Hesterberg, "What Teachers Should Know About the Bootstrap", The American Statistician 69 (2015), "expanded percentile interval".
///
/// A figure has none when the clusters are fewer than six, when too many draws leave it undefined, or when every draw gave the same: then
/// the data say nothing about how far off it is.
pub fn intervals_95<const N: usize>(clusters: usize, figures_of: impl Fn(&[u32]) -> [f64; N]) -> [Option<Interval>; N] {
    resampled([clusters], |[drawn]| figures_of(drawn))
}

/// Returns the 95 % interval of a figure of two sets of clusters, each of which is drawn by itself; widened as for the smaller one.
pub fn interval_95_of_two(clusters: [usize; 2], figure: impl Fn(&[u32], &[u32]) -> f64) -> Option<Interval> {
    let [interval] = resampled(clusters, |[one, other]| [figure(one, other)]);
    interval
}

/// [`intervals_95`] over several sets of clusters, each of which is drawn by itself.
fn resampled<const K: usize, const N: usize>(
    clusters: [usize; K],
    figures_of: impl Fn(&[Vec<u32>; K]) -> [f64; N],
) -> [Option<Interval>; N] {
    let fewest = clusters.into_iter().min().unwrap_or(0);
    if fewest < FEWEST_CLUSTERS {
        return [None; N];
    }
    let mut rng = Pcg64Mcg::seed_from_u64(SEED);
    let mut drawn = clusters.map(|clusters| vec![0; clusters]);
    let mut figures: [Vec<f64>; N] = std::array::from_fn(|_| Vec::with_capacity(DRAWS));
    for _ in 0..DRAWS {
        for drawn in &mut drawn {
            // How often each cluster comes in one resampling.
            drawn.fill(0);
            for _ in 0..drawn.len() {
                let cluster = rng.random_range(0..drawn.len());
                drawn[cluster] += 1;
            }
        }
        for (all, figure) in figures.iter_mut().zip(figures_of(&drawn)) {
            all.push(figure);
        }
    }
    figures.map(|drawn| interval_of(drawn, fewest))
}

pub fn interval_95(clusters: usize, figure: impl Fn(&[u32]) -> f64) -> Option<Interval> {
    let [interval] = intervals_95(clusters, |drawn| [figure(drawn)]);
    interval
}

/// Returns the percentiles of the draws. An undefined figure (NaN) may be anything, and so counts at both ends.
fn interval_of(mut figures: Vec<f64>, clusters: usize) -> Option<Interval> {
    figures.retain(|figure| !figure.is_nan());
    let undefined = DRAWS - figures.len();
    figures.sort_by(f64::total_cmp);
    let tail = expanded_tail(clusters) * DRAWS as f64;
    // The outer of the two draws next to the percentile.
    let from_end = (tail.floor() as usize).saturating_sub(1).checked_sub(undefined)?;
    let last = figures.len().checked_sub(1)?;
    let (low, high) = (figures[from_end], *figures.get(last.checked_sub(from_end)?)?);
    let alike = figures[last] - figures[0] < ALIKE;
    (!alike && low.is_finite() && high.is_finite()).then_some(Interval { low, high })
}

/// Returns the share of draws beyond each end: that of a normal beyond t·√(n/(n−1)), with Student's t for n − 1 degrees of freedom.
fn expanded_tail(clusters: usize) -> f64 {
    let n = clusters as f64;
    normal::upper_tail(students_t_95(n - 1.0) * (n / (n - 1.0)).sqrt())
}

/// Returns the t that 95 % of Student's distribution lies within, either side of 0; infinite for degrees of freedom that do not exist.
pub fn students_t_95(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}
