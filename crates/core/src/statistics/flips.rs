//! Paired differences of several measures in the same clusters, tested at once by flipping signs.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Largest number of clusters for which all patterns of signs are enumerated.
pub const EXACT_CLUSTERS: usize = 14;
/// Patterns drawn where there are more clusters.
pub const DRAWN_FLIPS: usize = 20_000;
/// The seed of these draws.
pub const FLIP_SEED: u64 = 1;
/// Statistics that differ by less are tied, and a tie counts as reached.
const TIED: f64 = 1e-9;

/// Computes the p of each measure, corrected for their number: `differences[k][c]` is the sum of measure `k`'s differences in cluster `c`.
///
/// If nothing made a difference, the two sides could as well be exchanged within a cluster, for all measures together: each pattern of signs of the
/// clusters is as likely as the one seen. The statistic of a measure is T = |Σd| / √Σd² (0 where all d are 0), whose denominator no pattern changes.
/// p is two-sided, and steps down by the largest T (Westfall and Young, *Resampling-Based Multiple Testing*, 1993, algorithm 4.1, which keeps the rate of
/// any wrong finding for any correlation of the measures). Patterns that are drawn count as by Phipson and Smyth, "Permutation P-values should never be
/// zero", Statistical Applications in Genetics and Molecular Biology 9 (2010): (b + 1) / (m + 1).
///
/// # Panics
/// Measures with different numbers of clusters.
pub fn sign_flip_p(differences: &[Vec<f64>]) -> Vec<f64> {
    let clusters = differences.first().map_or(0, Vec::len);
    assert!(
        differences.iter().all(|d| d.len() == clusters),
        "measures of different clusters"
    );
    let ordered = Ordered::of(differences);
    let mut reached = vec![0_u64; differences.len()];
    let patterns = ordered.visit_patterns(|sums| ordered.count(sums, &mut reached));
    ordered.stepped_down(&reached, patterns)
}

/// Computes the critical value of the largest statistic at a level: at most this share of the patterns of signs has a larger maximum.
pub fn sign_flip_critical(differences: &[Vec<f64>], level: f64) -> f64 {
    let ordered = Ordered::of(differences);
    let mut maxima = Vec::new();
    let largest = |sums: &[f64]| {
        sums.iter()
            .zip(&ordered.scales)
            .map(|(sum, scale)| sum.abs() * scale)
            .fold(0.0, f64::max)
    };
    ordered.visit_patterns(|sums| maxima.push(largest(sums)));
    maxima.sort_by(|a, b| b.total_cmp(a));
    let within = (level * maxima.len() as f64) as usize;
    maxima.get(within).map_or(f64::INFINITY, |critical| critical + TIED)
}

/// T = |Σd| / √Σd² of one measure, 0 where all d are 0.
pub fn sign_flip_statistic(differences: &[f64]) -> f64 {
    differences.iter().sum::<f64>().abs() * scale(differences)
}

/// 1 / √Σd², 0 where that is 0.
fn scale(differences: &[f64]) -> f64 {
    let norm = differences.iter().map(|d| d * d).sum::<f64>().sqrt();
    if norm > 0.0 { 1.0 / norm } else { 0.0 }
}

/// Returns the smallest p that [`sign_flip_p`] can give for a number of clusters: 2 · 2⁻ⁿ, or that of the draws.
pub fn smallest_sign_flip_p(clusters: usize) -> f64 {
    let exact = 2.0 * 0.5_f64.powi(i32::try_from(clusters).unwrap_or(i32::MAX));
    let drawn = 1.0 / (DRAWN_FLIPS as f64 + 1.0);
    if clusters <= EXACT_CLUSTERS {
        exact.min(1.0)
    } else {
        exact.max(drawn)
    }
}

/// Returns the share of an error rate that each family of corrected p may use: equal ones at first. A family of which everything is shown (p ≤ its share) gives its
/// share in equal parts to the others, until nothing changes (Bretz, Maurer, Brannath and Posch, "A graphical approach to sequentially rejective multiple
/// test procedures", Statistics in Medicine 28 (2009)).
pub fn shares(families: &[Vec<f64>], level: f64) -> Vec<f64> {
    let mut shares = vec![level / families.len().max(1) as f64; families.len()];
    let mut has_given = vec![false; families.len()];
    let gives = |i: usize, shares: &[f64]| !families[i].is_empty() && families[i].iter().all(|p| *p <= shares[i]);
    while let Some(giver) = (0..families.len()).find(|i| !has_given[*i] && gives(*i, &shares)) {
        has_given[giver] = true;
        let takers: Vec<usize> = (0..families.len()).filter(|i| !has_given[*i]).collect();
        for taker in &takers {
            shares[*taker] += shares[giver] / takers.len() as f64;
        }
    }
    shares
}

/// Clusters whose sums are kept for every pattern of their signs: a part of the 64 signs that are drawn at a time.
const TOGETHER: usize = 8;

/// The sums of few clusters for every pattern of their signs.
struct SignedSums {
    /// Measures.
    width: usize,
    /// Pattern by pattern; a bit that is set is a plus.
    sums: Vec<f64>,
}

impl SignedSums {
    fn of(clusters: &[Vec<f64>]) -> SignedSums {
        let width = clusters[0].len();
        let mut sums = vec![0.0; width << clusters.len()];
        for (pattern, sums) in sums.chunks_mut(width).enumerate() {
            for (c, differences) in clusters.iter().enumerate() {
                let sign = if pattern >> c & 1 == 1 { 1.0 } else { -1.0 };
                sums.iter_mut().zip(differences).for_each(|(sum, d)| *sum += sign * d);
            }
        }
        SignedSums { width, sums }
    }

    /// Returns the sums of the pattern in the lowest bits.
    fn by(&self, bits: u64) -> &[f64] {
        let patterns = self.sums.len() / self.width;
        let pattern = bits as usize % patterns;
        &self.sums[pattern * self.width..][..self.width]
    }
}

/// Measures from the largest statistic to the smallest.
struct Ordered {
    /// Positions in the order given.
    order: Vec<usize>,
    /// Differences in this order, by cluster.
    by_cluster: Vec<Vec<f64>>,
    /// That of each, by [`scale`].
    scales: Vec<f64>,
    seen: Vec<f64>,
}

impl Ordered {
    fn of(differences: &[Vec<f64>]) -> Ordered {
        let statistic = |k: usize| sign_flip_statistic(&differences[k]);
        let mut order: Vec<usize> = (0..differences.len()).collect();
        order.sort_by(|a, b| statistic(*b).total_cmp(&statistic(*a)));
        let clusters = differences.first().map_or(0, Vec::len);
        Ordered {
            by_cluster: (0..clusters)
                .map(|c| order.iter().map(|k| differences[*k][c]).collect())
                .collect(),
            scales: order.iter().map(|k| scale(&differences[*k])).collect(),
            seen: order.iter().map(|k| statistic(*k)).collect(),
            order,
        }
    }

    /// Counts one pattern's sums: at which ranks the largest statistic from there on reaches what was seen there.
    fn count(&self, sums: &[f64], reached: &mut [u64]) {
        let mut largest = 0.0_f64;
        for rank in (0..sums.len()).rev() {
            largest = largest.max(sums[rank].abs() * self.scales[rank]);
            reached[rank] += u64::from(largest >= self.seen[rank] - TIED);
        }
    }

    /// Shows each pattern's sums, in this order; the number of patterns. Up to [`EXACT_CLUSTERS`] all are shown, else some that are drawn and the one seen.
    fn visit_patterns(&self, visit: impl FnMut(&[f64])) -> u64 {
        if self.by_cluster.len() <= EXACT_CLUSTERS {
            self.visit_all(visit)
        } else {
            self.visit_drawn(visit)
        }
    }

    /// Visits all patterns but for an exchange of all signs, each from the one before by one sign (Gray 1953).
    fn visit_all(&self, mut visit: impl FnMut(&[f64])) -> u64 {
        let mut sums = self.sums_seen();
        let mut signs = vec![1.0; self.by_cluster.len()];
        let patterns = 1_u64 << self.by_cluster.len().saturating_sub(1);
        visit(&sums);
        for pattern in 1..patterns {
            let flipped = pattern.trailing_zeros() as usize;
            signs[flipped] = -signs[flipped];
            for (sum, d) in sums.iter_mut().zip(&self.by_cluster[flipped]) {
                *sum += 2.0 * signs[flipped] * d;
            }
            visit(&sums);
        }
        patterns
    }

    fn visit_drawn(&self, mut visit: impl FnMut(&[f64])) -> u64 {
        let mut rng = Pcg64Mcg::seed_from_u64(FLIP_SEED);
        let tables: Vec<SignedSums> = self.by_cluster.chunks(TOGETHER).map(SignedSums::of).collect();
        let mut sums = self.sums_seen();
        visit(&sums);
        for _ in 0..DRAWN_FLIPS {
            sums.fill(0.0);
            let mut bits = 0_u64;
            for (i, table) in tables.iter().enumerate() {
                if (i * TOGETHER).is_multiple_of(64) {
                    bits = rng.random();
                }
                sums.iter_mut().zip(table.by(bits)).for_each(|(sum, own)| *sum += own);
                bits >>= TOGETHER;
            }
            visit(&sums);
        }
        DRAWN_FLIPS as u64 + 1
    }

    fn sums_seen(&self) -> Vec<f64> {
        (0..self.order.len())
            .map(|rank| self.by_cluster.iter().map(|d| d[rank]).sum())
            .collect()
    }

    /// Shares of patterns, none smaller than that of a larger statistic, in the order given.
    fn stepped_down(&self, reached: &[u64], patterns: u64) -> Vec<f64> {
        let mut p = vec![1.0; self.order.len()];
        let mut largest = 0.0_f64;
        for (rank, k) in self.order.iter().enumerate() {
            largest = largest.max(reached[rank] as f64 / patterns as f64);
            p[*k] = largest;
        }
        p
    }
}
