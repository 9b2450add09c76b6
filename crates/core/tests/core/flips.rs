//! Paired tests by flipped signs: by hand, against a second implementation, and how often they find what is not there.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use scaleproof_core::statistics::{shares, sign_flip_p, smallest_sign_flip_p};

/// Step-down by its definition: every pattern of signs, and the largest statistic of the measures that are left.
fn by_definition(differences: &[Vec<f64>]) -> Vec<f64> {
    let clusters = differences[0].len();
    let statistic = |d: &[f64], pattern: u32| {
        let norm = d.iter().map(|d| d * d).sum::<f64>().sqrt();
        let signed = d
            .iter()
            .enumerate()
            .map(|(c, d)| if pattern >> c & 1 == 1 { -d } else { *d });
        if norm == 0.0 {
            0.0
        } else {
            signed.sum::<f64>().abs() / norm
        }
    };
    let mut left: Vec<usize> = (0..differences.len()).collect();
    let (mut p, mut largest) = (vec![0.0; differences.len()], 0.0_f64);
    left.sort_by(|a, b| statistic(&differences[*b], 0).total_cmp(&statistic(&differences[*a], 0)));
    while !left.is_empty() {
        let seen = statistic(&differences[left[0]], 0);
        let most = |pattern| {
            left.iter()
                .map(|k| statistic(&differences[*k], pattern))
                .fold(0.0, f64::max)
        };
        let reached = (0..1_u32 << clusters)
            .filter(|pattern| most(*pattern) >= seen - 1e-9)
            .count();
        largest = largest.max(reached as f64 / f64::from(1_u32 << clusters));
        p[left.remove(0)] = largest;
    }
    p
}

#[test]
fn p_is_that_counted_by_hand() {
    // Of 2⁸ patterns that seen and its opposite reach it.
    assert_eq!(sign_flip_p(&[vec![-0.3; 8]]), [2.0 / 256.0]);
    assert_eq!(smallest_sign_flip_p(8), 2.0 / 256.0);
    // Nothing seen, one pair, and no pair at all.
    assert_eq!(sign_flip_p(&[vec![0.0; 8], vec![0.0; 8]]), [1.0, 1.0]);
    assert_eq!(sign_flip_p(&[vec![-0.9]]), [1.0]);
    assert_eq!(sign_flip_p(&[Vec::new()]), [1.0]);
    assert!(sign_flip_p(&[]).is_empty());
    // Three of four the same way, ties: 1 + 1 + 1 − 1 = 2 or more is reached by 10 of 16.
    assert_eq!(sign_flip_p(&[vec![1.0, 1.0, 1.0, -1.0]]), [10.0 / 16.0]);
    // Two that move alike cost nothing; one in which a single pair moves is reached by every pattern.
    let alone = [vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], vec![0.2; 8], vec![0.4; 8]];
    assert_eq!(sign_flip_p(&alone), [1.0, 2.0 / 256.0, 2.0 / 256.0]);
}

#[test]
fn drawn_patterns_are_near_all_and_never_nothing() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let differences: Vec<Vec<f64>> = (0..3)
        .map(|k| {
            (0..16)
                .map(|_| rng.random_range(-1.0..1.0) + 0.15 * f64::from(k))
                .collect()
        })
        .collect();
    for (drawn, exact) in sign_flip_p(&differences).into_iter().zip(by_definition(&differences)) {
        let deviation = (exact * (1.0 - exact) / 20_000.0).sqrt();
        assert!((drawn - exact).abs() < 4.0 * deviation + 1e-4, "{drawn}, not {exact}");
    }
    let certain = sign_flip_p(&[vec![1.0; 40]]);
    assert_eq!(certain, [1.0 / 20_001.0]);
    assert_eq!(smallest_sign_flip_p(40), certain[0]);
}

#[test]
fn a_family_that_is_shown_whole_gives_its_share_to_the_others() {
    assert_eq!(shares(&[vec![0.02, 0.03]], 0.05), [0.05]);
    // Half each; the first is shown whole, so the second has all, and is shown, too.
    assert_eq!(shares(&[vec![0.01, 0.02], vec![0.04]], 0.05), [0.025, 0.05]);
    // One of two is not enough.
    assert_eq!(shares(&[vec![0.01, 0.03], vec![0.04]], 0.05), [0.025, 0.025]);
    assert!(shares(&[], 0.05).is_empty());
}

/// Where nothing differs, any wrong finding in 5 % of experiments at most, however the measures hang together.
#[test]
fn nothing_is_found_too_often_where_there_is_nothing() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    let (experiments, mut wrong) = (4000, 0);
    let mut noise = |width: f64| width * (0..6).map(|_| rng.random_range(-1.0..1.0)).sum::<f64>();
    for _ in 0..experiments {
        let common: Vec<f64> = (0..8).map(|_| noise(1.0)).collect();
        let measures: Vec<Vec<f64>> = (0..5)
            .map(|_| common.iter().map(|c| c + noise(0.7)).collect())
            .collect();
        wrong += usize::from(sign_flip_p(&measures).into_iter().any(|p| p <= 0.05));
    }
    let share = wrong as f64 / f64::from(experiments);
    assert!(
        share < 0.05 + 2.5 * (0.05_f64 * 0.95 / f64::from(experiments)).sqrt(),
        "{share}"
    );
}

proptest! {
    #[test]
    fn p_is_that_of_the_definition(
        measures in 1_usize..5,
        values in prop::collection::vec((-4_i32..5, 0_u32..3), 4 * 9),
        clusters in 1_usize..9,
    ) {
        // Small numbers, so that there are ties.
        let value = |(number, kind): (i32, u32)| f64::from(number) * [0.1, 0.5, 0.0][kind as usize];
        let differences: Vec<Vec<f64>> = values.chunks(9).take(measures).map(|row| row[..clusters].iter().copied().map(value).collect()).collect();
        let (found, expected) = (sign_flip_p(&differences), by_definition(&differences));
        for (found, expected) in found.into_iter().zip(expected) {
            prop_assert!((found - expected).abs() < 1e-12, "{found}, not {expected}");
        }
    }
}
