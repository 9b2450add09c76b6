//! The clone of CAMOU against what another engine computed.

use std::path::Path;

use burn::module::Param;
use burn::optim::{AdamConfig, GradientsParams};
use burn::tensor::{Device, Tensor, TensorData};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use scaleproof_attack::baseline::camou::{Clone2d, TRAINING_RATE, cross_entropy, input};
use serde::{Deserialize, Serialize};

const SIDE: usize = 7;
/// The numbers that go into each output of a layer, and its outputs.
const LAYERS: [[usize; 2]; 4] = [[27, 16], [144, 32], [32 * 9, 32], [32, 1]];

#[derive(Debug, Serialize, Deserialize)]
struct Course {
    losses: Vec<f32>,
    /// Of the first step, by weights and biases of each layer: every so many.
    by_weights: Vec<f32>,
    /// Of the first step's loss, by the first pattern.
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
    let scores = || vec![0.9, 0.1, 0.5, 0.7, 0.3];
    let device = Device::flex().autodiff();
    let mut clone = Clone2d::new(SIDE, &device);
    let of = |list: &Vec<f32>, shape: &[usize]| TensorData::new(list.clone(), shape.to_vec());
    let four = |list, shape: [usize; 4]| Param::from_tensor(Tensor::<4>::from_data(of(list, &shape), &device));
    let two =
        |list, shape: [usize; 2]| Param::from_tensor(Tensor::<2>::from_data(of(list, &shape), &device).transpose());
    let one = |list: &Vec<f32>| {
        Some(Param::from_tensor(Tensor::<1>::from_data(
            of(list, &[list.len()]),
            &device,
        )))
    };
    (clone.first.weight, clone.first.bias) = (four(&start[0], [16, 3, 3, 3]), one(&start[1]));
    (clone.second.weight, clone.second.bias) = (four(&start[2], [32, 16, 3, 3]), one(&start[3]));
    (clone.hidden.weight, clone.hidden.bias) = (two(&start[4], [32, 32 * 9]), one(&start[5]));
    (clone.last.weight, clone.last.bias) = (two(&start[6], [1, 32]), one(&start[7]));
    let mut adam = AdamConfig::new().init();
    let (mut losses, mut by_weights, mut by_pattern) = (Vec::new(), Vec::new(), Vec::new());
    for step in 0..3 {
        let x = input(&patterns, &device).require_grad();
        let loss = cross_entropy(&clone, x.clone(), scores());
        losses.push(loss.clone().into_data().to_vec::<f32>().unwrap()[0]);
        let gradients = loss.backward();
        if step == 0 {
            by_pattern = x.grad(&gradients).unwrap().into_data().to_vec::<f32>().unwrap()[..3 * SIDE * SIDE].to_vec();
            let lists = weights(
                &clone,
                |w| w.grad(&gradients).unwrap(),
                |w| w.grad(&gradients).unwrap(),
                |w| w.grad(&gradients).unwrap(),
            );
            by_weights = some(&lists);
        }
        let gradients = GradientsParams::from_grads(gradients, &clone);
        clone = adam.step(TRAINING_RATE, clone, gradients);
    }
    Course {
        losses,
        by_weights,
        by_pattern,
        weights: some(&weights(&clone, |w| w, |w| w, |w| w)),
    }
}

fn weights(
    clone: &Clone2d,
    four: impl Fn(Tensor<4>) -> Tensor<4>,
    two: impl Fn(Tensor<2>) -> Tensor<2>,
    one: impl Fn(Tensor<1>) -> Tensor<1>,
) -> Vec<Vec<f32>> {
    let bias = |b: &Option<Param<Tensor<1>>>| one(b.as_ref().unwrap().val()).into_data().to_vec::<f32>().unwrap();
    vec![
        four(clone.first.weight.val()).into_data().to_vec::<f32>().unwrap(),
        bias(&clone.first.bias),
        four(clone.second.weight.val()).into_data().to_vec::<f32>().unwrap(),
        bias(&clone.second.bias),
        two(clone.hidden.weight.val())
            .transpose()
            .into_data()
            .to_vec::<f32>()
            .unwrap(),
        bias(&clone.hidden.bias),
        two(clone.last.weight.val())
            .transpose()
            .into_data()
            .to_vec::<f32>()
            .unwrap(),
        bias(&clone.last.bias),
    ]
}

/// `data/clone.json` was written by this test, with `SCALEPROOF_WRITE_COURSES` set, when burn 0.22.1 computed the clone.
#[test]
fn the_clone_learns_as_on_another_engine() -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/clone.json");
    let found = course();
    if std::env::var_os("SCALEPROOF_WRITE_COURSES").is_some() {
        std::fs::create_dir_all(path.parent().unwrap())?;
        std::fs::write(&path, serde_json::to_string(&found)? + "\n")?;
    }
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
