//! How many places show a drop of the hit rate, as `compare` tests it: from six on each place is one cluster.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::plan::{MOST_PAIRS, PlanError, binomial, first_of_run, pairs_needed, power, smallest_drop};
use scaleproof_core::statistics::{DRAWS, FEWEST_CLUSTERS, SEED, mcnemar_p};

/// The level at which a drop is shown.
const LEVEL: f64 = 0.05;

/// So many clusters show what their pairs show, however many those are.
const MANY_PLACES: usize = 50;

/// The chance that `compare` shows a drop with one pair in each bin of each place.
///
/// Exact where it takes the pairs as independent of each other; where each place changes sides as a whole, by simulation.
pub fn power_by_place(places: usize, bins: usize, base_rate: f64, drop: f64) -> f64 {
    power_at(LEVEL, places, bins, [base_rate, drop])
}

/// At another level, as that of Holm's correction for several comparisons at its strictest.
fn power_at(level: f64, places: usize, bins: usize, [base_rate, drop]: [f64; 2]) -> f64 {
    if places < FEWEST_CLUSTERS || bins == 1 {
        power(places * bins, base_rate, drop, level)
    } else {
        simulated(level, places, &Place::new(bins, base_rate, drop))
    }
}

/// The smallest drop, in steps of 0.01, that so many places show with the chance asked for; `None` when not even the largest is.
pub fn smallest_drop_by_place(places: usize, bins: usize, base_rate: f64, target: f64) -> Option<f64> {
    smallest_drop_among(1, places, bins, [base_rate, target])
}

/// As [`smallest_drop_by_place`], for a drop that is shown after correction for so many tests, at the strictest level of Holm's.
pub fn smallest_drop_among(tests: usize, places: usize, bins: usize, [base_rate, target]: [f64; 2]) -> Option<f64> {
    let level = LEVEL / tests.max(1) as f64;
    smallest_drop(base_rate, |drop| {
        power_at(level, places, bins, [base_rate, drop]) >= target
    })
}

/// The fewest places from which on the power is reached: also at six, where the pairs of a place begin to count as one.
pub fn places_needed(bins: usize, base_rate: f64, drop: f64, target: f64) -> Result<usize, PlanError> {
    places_needed_among(1, bins, [base_rate, drop], target)
}

/// As [`places_needed`], for a drop that is shown after correction for so many tests, at the strictest level of Holm's.
pub fn places_needed_among(
    tests: usize,
    bins: usize,
    [base_rate, drop]: [f64; 2],
    target: f64,
) -> Result<usize, PlanError> {
    /// Single numbers at which it falls back are passed over.
    const AHEAD: usize = 2;
    let (bins, level) = (bins.max(1), LEVEL / tests.max(1) as f64);
    // Clusters never show more than the pairs that they are made of.
    let least = pairs_needed(base_rate, drop, target, level)?.div_ceil(bins);
    let most = (MOST_PAIRS / bins).max(MANY_PLACES) + AHEAD;
    let is_shown = |places| power_at(level, places, bins, [base_rate, drop]) >= target;
    let first = first_of_run(least.max(FEWEST_CLUSTERS)..=most, AHEAD, is_shown)?;
    Ok(if first == FEWEST_CLUSTERS { least } else { first })
}

/// The pairs of one place: the chances that so many more of them are hit on the base side.
struct Place {
    /// Chance of at most −bins, −bins + 1, …, bins.
    cumulated: Vec<f64>,
    bins: usize,
}

impl Place {
    fn new(bins: usize, base_rate: f64, drop: f64) -> Place {
        // Rounding may take the rate below 0.
        let [base, other] = [base_rate, (base_rate - drop).max(0.0)].map(|rate| binomial(bins, rate));
        let mut chances = vec![0.0; 2 * bins + 1];
        for (hits, p) in base.iter().enumerate() {
            for (lost, q) in other.iter().enumerate() {
                chances[bins + hits - lost] += p * q;
            }
        }
        let mut sum = 0.0;
        let cumulated = chances.iter().map(|chance| {
            sum += chance;
            sum
        });
        let cumulated = cumulated.collect();
        Place { cumulated, bins }
    }

    /// The difference of the hits that stands at a share of all chances.
    fn at(&self, share: f64) -> i64 {
        let index = self.cumulated.partition_point(|sum| *sum <= share);
        index.min(2 * self.bins) as i64 - self.bins as i64
    }
}

/// Share of simulated comparisons that show the drop. Every plan gets the same random numbers, so that a larger drop is not shown less by chance.
fn simulated(level: f64, places: usize, place: &Place) -> f64 {
    let mut rng = Pcg64Mcg::seed_from_u64(SEED);
    let shows = |_: &usize| {
        let sums: Vec<i64> = (0..places).map(|_| place.at(rng.random_range(0.0..1.0))).collect();
        sums.iter().sum::<i64>() > 0 && mcnemar_p(&sums) < level
    };
    (0..DRAWS).filter(shows).count() as f64 / DRAWS as f64
}
