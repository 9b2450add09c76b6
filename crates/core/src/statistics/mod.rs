//! Medians, distributions, intervals, exact tests and orders.

mod bootstrap;
pub mod normal;
mod paired;
mod sequential;
pub use bootstrap::{
    ALIKE, DRAWS, FEWEST_CLUSTERS, Interval, SEED, interval_95, interval_95_of_two, intervals_95, students_t_95,
};
pub use paired::{holm, mcnemar_p};
pub use sequential::{Sequence, Shown};

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

/// The Wilson score interval of a rate (Wilson 1927): 95 % interval of `hits` out of `n`; `None` for n = 0.
pub fn wilson_95(hits: usize, n: usize) -> Option<(f64, f64)> {
    if n == 0 {
        return None;
    }
    const Z: f64 = normal::TWO_SIDED_95;
    let (n, p) = (n as f64, hits as f64 / n as f64);
    let centre = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    Some((((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0)))
}

/// Kendall's τ-b of two lists of figures (Kendall 1945): 1 where both have one order, −1 where one has the order of the other reversed.
/// Figures that differ by less than `alike` are ties; `None` where a list has nothing but ties.
pub fn kendall_tau_b(a: &[f64], b: &[f64], alike: f64) -> Option<f64> {
    let sign = |difference: f64| match difference {
        d if d > alike => 1.0,
        d if d < -alike => -1.0,
        _ => 0.0,
    };
    let (mut agreeing, mut ordered_a, mut ordered_b) = (0.0, 0.0, 0.0);
    for i in 0..a.len() {
        for j in 0..i {
            let (of_a, of_b): (f64, f64) = (sign(a[i] - a[j]), sign(b[i] - b[j]));
            agreeing += of_a * of_b;
            ordered_a += of_a.abs();
            ordered_b += of_b.abs();
        }
    }
    let both = ordered_a * ordered_b;
    (both > 0.0).then(|| agreeing / f64::sqrt(both))
}
