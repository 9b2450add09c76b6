//! Medians, distributions, intervals, exact tests and orders.

mod bootstrap;
mod flips;
pub mod normal;
mod sequential;
pub use bootstrap::{
    ALIKE, DRAWS, FEWEST_CLUSTERS, Interval, SEED, interval_95, interval_95_of_two, intervals_95, students_t_95,
};
pub use flips::{
    DRAWN_FLIPS, EXACT_CLUSTERS, FLIP_SEED, shares, sign_flip_critical, sign_flip_p, sign_flip_statistic,
    smallest_sign_flip_p,
};
pub use sequential::{Sequence, Shown};

/// Returns the middle value, or the mean of the middle two; `None` of nothing.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (lower, upper) = (sorted.len().checked_sub(1)? / 2, sorted.len() / 2);
    Some((sorted[lower] + sorted[upper]) / 2.0)
}

/// Returns the middle value, or the larger of the middle two: always one that was measured. `None` of nothing.
pub fn upper_median(values: &[f64]) -> Option<f64> {
    let (mut values, middle) = (values.to_vec(), values.len() / 2);
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns the Wilson score interval of a rate (Wilson 1927): 95 % interval of `hits` out of `n`; `None` for n = 0.
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

/// Computes Kendall's τ-b of two lists of values (Kendall 1945): 1 where both rank alike, −1 where one ranking is the other's reverse. Values that differ
/// by `tolerance` or less are ties; `None` where all of a list are tied.
pub fn kendall_tau_b(a: &[f64], b: &[f64], tolerance: f64) -> Option<f64> {
    let sign = |difference: f64| match difference {
        d if d > tolerance => 1.0,
        d if d < -tolerance => -1.0,
        _ => 0.0,
    };
    let (mut concordance, mut untied_a, mut untied_b) = (0.0, 0.0, 0.0);
    for i in 0..a.len() {
        for j in 0..i {
            let (of_a, of_b): (f64, f64) = (sign(a[i] - a[j]), sign(b[i] - b[j]));
            concordance += of_a * of_b;
            untied_a += of_a.abs();
            untied_b += of_b.abs();
        }
    }
    let both = untied_a * untied_b;
    (both > 0.0).then(|| concordance / f64::sqrt(both))
}

/// Computes the two-sided p of McNemar's exact test (McNemar 1947), with repeats of one place and bin kept together.
///
/// `differences` has, for each cluster, the photos hit on the base side minus those hit on the other. If the texture made no
/// difference, each could as well have had the other sign; p is the share of all sign patterns whose sum is as far from 0 as
/// the one seen. With one pair a cluster this is the binomial of the discordant pairs, which is McNemar's.
pub fn mcnemar_p(differences: &[i64]) -> f64 {
    let reach: i64 = differences.iter().map(|d| d.abs()).sum();
    let seen = differences.iter().sum::<i64>().abs();
    // Probability of each sum, from −reach to reach.
    let mut chance = vec![0.0; 2 * reach as usize + 1];
    chance[reach as usize] = 1.0;
    for step in differences.iter().map(|d| d.unsigned_abs() as usize).filter(|d| *d > 0) {
        let mut next = vec![0.0; chance.len()];
        for (sum, p) in chance.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            next[sum - step] += p / 2.0;
            next[sum + step] += p / 2.0;
        }
        chance = next;
    }
    let far = (-reach..=reach).zip(&chance).filter(|(sum, _)| sum.abs() >= seen);
    far.map(|(_, p)| p).sum::<f64>().min(1.0)
}

/// Corrects p values for their number, in the order given (Holm 1979): each may be compared with 0.05 by itself.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let mut corrected = vec![0.0; p.len()];
    let mut least = 0.0_f64;
    for (rank, i) in order.into_iter().enumerate() {
        least = least.max((p[i] * (p.len() - rank) as f64).min(1.0));
        corrected[i] = least;
    }
    corrected
}
