//! Random numbers and views of a step.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg32;

/// Draws the views of a step: every view comes once before any comes again, in a new random order each time.
pub fn batch(views: &[usize], size: u32, seed: u64, step: u32) -> Vec<usize> {
    let size = (size as usize).min(views.len());
    let shuffled = |round: usize| {
        let mut order = views.to_vec();
        order.shuffle(&mut drawn_by(seed ^ 0x5eed, round as u32));
        order
    };
    let first = step as usize * size;
    let mut orders = std::collections::BTreeMap::new();
    let at = |i: usize| {
        let round = i / views.len();
        orders.entry(round).or_insert_with(|| shuffled(round))[i % views.len()]
    };
    (first..first + size).map(at).collect()
}

/// Returns a generator that depends on the seed and the step alone, so that a resumed run draws as one that never stopped.
pub fn drawn_by(seed: u64, step: u32) -> Pcg32 {
    Pcg32::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(u64::from(step)))
}
