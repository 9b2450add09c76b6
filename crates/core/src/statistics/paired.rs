//! Exact tests of paired hits, and Holm's correction for many of them.

/// Two-sided p of McNemar's exact test (McNemar 1947), with repeats of one place and bin kept together.
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

/// p values corrected for their number, in the order given (Holm 1979): each may be held against 0.05 by itself.
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
