//! How many pairs of photos show a drop of the hit rate.

use std::ops::RangeInclusive;

use statrs::distribution::{Binomial, Discrete};

/// Why no number can be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanError {
    #[error("the drop must lie above 0 and not above the hit rate of the base, {base_rate}: it is {drop}")]
    Drop { drop: f64, base_rate: f64 },
    #[error("the hit rate of the base must lie above 0 and not above 1: it is {0}")]
    BaseRate(f64),
    #[error("the least drop that matters, {least}, must not be above the drop that is planned for, {drop}")]
    Least { least: f64, drop: f64 },
    #[error("the power must lie from 0.5 to 0.99: it is {0}")]
    Power(f64),
    #[error("more than {MOST_PAIRS} pairs would be needed: such a drop is too small for photos")]
    TooMany,
}

/// More pairs than anyone photographs.
pub(super) const MOST_PAIRS: usize = 2000;

/// The chance that McNemar's exact test shows the drop at level `alpha` with `pairs` pairs, one a place and bin.
///
/// Exact: the hits of a pair are taken as independent of each other (photos alike in difficulty need fewer pairs), so that the
/// discordant pairs are binomial, and those of them that speak for the drop are binomial again.
pub fn power(pairs: usize, base_rate: f64, drop: f64, alpha: f64) -> f64 {
    Tails::new(pairs, base_rate, drop, alpha).power(pairs)
}

/// The smallest drop, in steps of 0.01, that is shown; `None` when not even the largest is.
pub(super) fn smallest_drop(base_rate: f64, shows: impl Fn(f64) -> bool) -> Option<f64> {
    let steps = (base_rate * 100.0 + 1e-9).floor() as u32;
    let drops: Vec<f64> = (1..=steps).map(|step| f64::from(step) / 100.0).collect();
    // The larger the drop, the surer it is shown.
    let first = drops.partition_point(|drop| !shows(*drop));
    drops.get(first).copied()
}

/// The fewest pairs from which on the power is reached (it falls back a little at single numbers, which are passed over).
pub fn pairs_needed(base_rate: f64, drop: f64, target: f64, alpha: f64) -> Result<usize, PlanError> {
    if !(base_rate > 0.0 && base_rate <= 1.0) {
        return Err(PlanError::BaseRate(base_rate));
    }
    if !(drop > 0.0 && drop <= base_rate) {
        return Err(PlanError::Drop { drop, base_rate });
    }
    if !(0.5..=0.99).contains(&target) {
        return Err(PlanError::Power(target));
    }
    // A saw tooth spans far fewer pairs than this.
    const AHEAD: usize = 20;
    let tails = Tails::new(MOST_PAIRS + AHEAD, base_rate, drop, alpha);
    first_of_run(1..=MOST_PAIRS + AHEAD, AHEAD, |pairs| tails.power(pairs) >= target)
}

/// The first number from which on this holds: for it, and for so many `ahead` of it.
pub(super) fn first_of_run(
    numbers: RangeInclusive<usize>,
    ahead: usize,
    holds: impl Fn(usize) -> bool,
) -> Result<usize, PlanError> {
    let mut run = 0;
    for number in numbers {
        run = if holds(number) { run + 1 } else { 0 };
        if run > ahead {
            return Ok(number - ahead);
        }
    }
    Err(PlanError::TooMany)
}

/// The chance of a significant drop for each number of discordant pairs.
struct Tails {
    discordant: f64,
    significant: Vec<f64>,
}

impl Tails {
    fn new(most: usize, base_rate: f64, drop: f64, alpha: f64) -> Tails {
        let other = base_rate - drop;
        let (base_alone, other_alone) = (base_rate * (1.0 - other), (1.0 - base_rate) * other);
        // A sum of probabilities that rounding may take above 1.
        let discordant = (base_alone + other_alone).min(1.0);
        let share = base_alone / discordant;
        let significant = (0..=most).map(|n| {
            let fair = binomial(n, 0.5);
            let speaking = binomial(n, share);
            let mut tail = 0.0;
            let mut chance = 0.0;
            // From the clearest outcome down, while two tails of a fair coin stay within the level.
            for k in (0..=n).rev() {
                tail += fair[k];
                if 2 * k <= n || 2.0 * tail > alpha {
                    break;
                }
                chance += speaking[k];
            }
            chance
        });
        let significant = significant.collect();
        Tails {
            discordant,
            significant,
        }
    }

    fn power(&self, pairs: usize) -> f64 {
        let chances = binomial(pairs, self.discordant);
        chances.iter().zip(&self.significant).map(|(p, s)| p * s).sum()
    }
}

/// The probabilities of 0 to `n` successes; not finite when `p` is no probability.
///
/// From the likeliest number outwards, each by the ratio to its neighbour, P(k) = P(k − 1) · (n − k + 1) / k · p / (1 − p): each factor is below 1, so that rounding does not grow.
pub(super) fn binomial(n: usize, p: f64) -> Vec<f64> {
    let (mode, odds) = ((((n + 1) as f64 * p) as usize).min(n), p / (1.0 - p));
    let likeliest = Binomial::new(p, n as u64).map_or(f64::NAN, |b| b.pmf(mode as u64));
    let mut chances = vec![likeliest; n + 1];
    let ratio = |k: usize| (n - k + 1) as f64 / k as f64 * odds;
    for k in mode + 1..=n {
        chances[k] = chances[k - 1] * ratio(k);
    }
    for k in (0..mode).rev() {
        chances[k] = chances[k + 1] / ratio(k + 1);
    }
    chances
}
