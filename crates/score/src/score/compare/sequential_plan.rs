//! How many pairs a comparison takes that stops as soon as it knows, by simulation, against a plan that is fixed in advance.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::plan::{MOST_PAIRS, PlanError, pairs_needed, power as exact_power};
use scaleproof_core::statistics::{SEED, Sequence, Shown};

/// Simulated experiments behind each row.
const EXPERIMENTS: usize = 5000;

/// Multiples of the drop that is planned for: what the real one may be.
const REAL: [f64; 7] = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];

/// Rows that are simulated at most, and the budget before them.
pub const SEQUENTIAL_ROWS: usize = REAL.len() + 1;

/// Two plans that show the same drop with the same chance.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct SequentialPlan {
    /// As requested, with `drop`, `power` and `least` (the drop that matters; `null` where none is named).
    pub base_rate: f64,
    pub drop: f64,
    pub power: f64,
    pub least: Option<f64>,
    /// Pairs of the fixed plan, which is looked at once (McNemar's exact test).
    pub fixed_pairs: usize,
    /// The most pairs that the sequential plan takes.
    pub budget_pairs: usize,
    /// Simulated experiments behind each row of `table`.
    pub experiments: usize,
    pub table: Vec<Expected>,
}

/// What becomes of experiments whose real drop is so large.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Expected {
    /// The drop of the hit rate that is simulated.
    pub real_drop: f64,
    /// Share of the experiments that show a drop; `rise_shown`, `less_than_least_shown` and `undecided` are the other shares.
    pub drop_shown: f64,
    /// Chance that the fixed plan shows a drop, computed exactly.
    pub fixed_drop_shown: f64,
    pub rise_shown: f64,
    pub less_than_least_shown: f64,
    pub undecided: f64,
    /// Mean number of pairs until the sequential plan stops.
    pub mean_pairs: f64,
    /// Mean pairs saved, as a share of the fixed plan's; negative where it takes more.
    pub saved: f64,
}

pub fn sequential_plan(
    (base_rate, drop): (f64, f64),
    power: f64,
    least: Option<f64>,
    on_row: impl Fn(),
) -> Result<SequentialPlan, PlanError> {
    if let Some(least) = least.filter(|least| *least > drop) {
        return Err(PlanError::Least { least, drop });
    }
    let fixed_pairs = pairs_needed(base_rate, drop, power, 0.05)?;
    let planned = ends(base_rate, drop, least, MOST_PAIRS);
    on_row();
    let shown_after = |(shown, after): &_| {
        if *shown == Some(Shown::Above) {
            *after
        } else {
            usize::MAX
        }
    };
    let mut shown_after: Vec<usize> = planned.iter().map(shown_after).collect();
    shown_after.sort_unstable();
    let budget_pairs = shown_after[(power * EXPERIMENTS as f64).ceil() as usize - 1];
    if budget_pairs > MOST_PAIRS {
        return Err(PlanError::TooMany);
    }
    // Free of the rounding of the product.
    let real = REAL.map(|times| (times * drop * 1e9).round() / 1e9);
    let rows = real.into_iter().filter(|real| *real <= base_rate);
    let row = |real: f64| {
        let fixed = exact_power(fixed_pairs, base_rate, real, 0.05).max(0.0); // not a number where no pair can differ
        let row = expected((real, fixed), &ends(base_rate, real, least, budget_pairs), fixed_pairs);
        on_row();
        row
    };
    Ok(SequentialPlan {
        base_rate,
        drop,
        power,
        least,
        fixed_pairs,
        budget_pairs,
        experiments: EXPERIMENTS,
        table: rows.map(row).collect(),
    })
}

/// What each experiment shows first, and after how many pairs; nothing after all of them.
fn ends(base_rate: f64, drop: f64, least: Option<f64>, budget: usize) -> Vec<(Option<Shown>, usize)> {
    let mut rng = Pcg64Mcg::seed_from_u64(SEED);
    let other_rate = (base_rate - drop).max(0.0);
    let experiment = |_| {
        let mut sequence = Sequence::new(1, least);
        for pair in 1..=budget {
            let [base, other] = [base_rate, other_rate].map(|rate| f64::from(u8::from(rng.random_bool(rate))));
            sequence.see(0, base - other);
            if let Some((shown, _)) = sequence.shown() {
                return (Some(shown), pair);
            }
        }
        (None, budget)
    };
    (0..EXPERIMENTS).map(experiment).collect()
}

fn expected(
    (real_drop, fixed_drop_shown): (f64, f64),
    ends: &[(Option<Shown>, usize)],
    fixed_pairs: usize,
) -> Expected {
    let share = |of: Option<Shown>| ends.iter().filter(|end| end.0 == of).count() as f64 / ends.len() as f64;
    let mean_pairs = ends.iter().map(|end| end.1 as f64).sum::<f64>() / ends.len() as f64;
    Expected {
        real_drop,
        drop_shown: share(Some(Shown::Above)),
        fixed_drop_shown,
        rise_shown: share(Some(Shown::Below)),
        less_than_least_shown: share(Some(Shown::LessThanLeast)),
        undecided: share(None),
        mean_pairs,
        saved: 1.0 - mean_pairs / fixed_pairs as f64,
    }
}
