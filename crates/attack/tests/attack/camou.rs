//! The clone of CAMOU against what another engine computed.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_attack::baseline::camou::Clone2d;
use serde::{Deserialize, Serialize};

const SIDE: usize = 7;
/// The numbers that go into each output of a layer, and its outputs.
const LAYERS: [[usize; 2]; 4] = [[27, 16], [144, 32], [32 * 9, 32], [32, 1]];

#[derive(Debug, Serialize, Deserialize)]
struct Course {
    losses: Vec<f32>,
    /// Gradient of the first step's loss by weights and biases of each layer: a sample of its numbers.
    by_weights: Vec<f32>,
    /// Gradient of the first step's loss by the first pattern.
    by_pattern: Vec<f32>,
    /// After three steps: every so many.
    weights: Vec<f32>,
}

/// About so many of a list, for a file.
fn some(lists: &[Vec<f32>]) -> Vec<f32> {
    let some = |list: &Vec<f32>| Vec::from_iter(list.iter().step_by(list.len().div_ceil(20)).copied());
    lists.iter().flat_map(some).collect()
}

/// Weights (outputs × inputs) and biases of each layer.
fn lists(rng: &mut Pcg32) -> Vec<Vec<f32>> {
    let lists = LAYERS
        .iter()
        .flat_map(|[ins, outs]| [(ins * outs, *ins), (*outs, *ins)]);
    let list = |(count, ins): (usize, usize)| {
        let most = 1.0 / (ins as f32).sqrt();
        Vec::from_iter((0..count).map(|_| rng.random_range(-most..most)))
    };
    lists.map(list).collect()
}

fn patterns(rng: &mut Pcg32) -> Vec<Vec<[f64; 3]>> {
    let mut pattern = |_| Vec::from_iter((0..SIDE * SIDE).map(|_| std::array::from_fn(|_| rng.random())));
    (0..5).map(&mut pattern).collect()
}

fn course() -> Course {
    let mut rng = Pcg32::seed_from_u64(8);
    let (start, patterns) = (lists(&mut rng), patterns(&mut rng));
    let patterns: Vec<&[[f64; 3]]> = patterns.iter().map(Vec::as_slice).collect();
    let samples: Vec<_> = patterns.iter().copied().zip([0.9, 0.1, 0.5, 0.7, 0.3]).collect();
    let mut clone = Clone2d::new(SIDE, &mut rng);
    clone.lists = start;
    let (_, by_weights) = clone.loss_and_gradient(&samples);
    let (score, gradient) = clone.score_and_gradient(patterns[0]);
    // From the derivative of a sigmoid to that of the mean cross-entropy of five.
    let share = (score - samples[0].1) / (score * (1.0 - score)) / 5.0;
    let channel = |c: usize| gradient.iter().map(move |cell| (share * cell[c]) as f32);
    Course {
        by_weights: some(&by_weights),
        by_pattern: (0..3).flat_map(channel).collect(),
        losses: (0..3).map(|_| clone.step(&samples) as f32).collect(),
        weights: some(&clone.lists),
    }
}

/// `data/clone.json` was written by this test when burn 0.22.1 computed the clone.
#[test]
fn the_clone_learns_as_on_another_engine() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/clone.json");
    let found = course();
    let stored: Course = serde_json::from_slice(&std::fs::read(&path)?)?;
    for (name, found, stored, part) in [
        ("losses", &found.losses, &stored.losses, 1e-5),
        ("by weights", &found.by_weights, &stored.by_weights, 1e-4),
        ("by the pattern", &found.by_pattern, &stored.by_pattern, 1e-4),
        ("weights", &found.weights, &stored.weights, 1e-4),
    ] {
        let largest = stored.iter().fold(0.0, |most: f32, v| most.max(v.abs()));
        assert_eq!(found.len(), stored.len(), "{name}");
        for (found, stored) in found.iter().zip(stored) {
            assert!((found - stored).abs() < part * largest, "{name}: {found} for {stored}");
        }
    }
    Ok(())
}
