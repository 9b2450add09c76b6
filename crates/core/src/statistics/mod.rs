//! Medians, distributions, intervals, exact tests and orders.

mod bootstrap;
pub mod normal;
mod paired;
mod ranks;
mod sequential;
mod wilson;
pub use bootstrap::{
    ALIKE, DRAWS, FEWEST_CLUSTERS, Interval, SEED, interval_95, interval_95_of_two, intervals_95, students_t_95,
};
pub use paired::{holm, mcnemar_p};
pub use ranks::kendall_tau_b;
pub use sequential::{Sequence, Shown};
pub use wilson::wilson_95;

/// The middle value, or the mean of the middle two; `None` of nothing.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (lower, upper) = (sorted.len().checked_sub(1)? / 2, sorted.len() / 2);
    Some((sorted[lower] + sorted[upper]) / 2.0)
}

/// The middle value, or the larger of the middle two: always one that was measured. `None` of nothing.
pub fn upper_median(values: &[f64]) -> Option<f64> {
    let (mut values, middle) = (values.to_vec(), values.len() / 2);
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
