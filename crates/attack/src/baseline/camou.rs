//! CAMOU (Zhang et al., ICLR 2019): a clone network learns what renderer and detector say of patterns, and the pattern
//! goes down the clone's gradient; the two alternate, and the clone learns next from the patterns of that descent.
//!
//! The paper's clone sees the pattern tiled on a view; ours sees the pattern alone and imitates the mean score over a
//! minibatch of views, which is the expectation that the paper's loss takes.

use burn::module::Module;
use burn::nn::conv::{Conv2d, Conv2dConfig};
use burn::nn::{Linear, LinearConfig};
use burn::optim::{AdamConfig, GradientsParams, ModuleOptimizer};
use burn::tensor::activation::{relu, sigmoid};
use burn::tensor::{Device, Tensor, TensorData};
use rand::{Rng, RngExt};

use super::{BlackBox, SearchConfig};
use crate::run::adam::Adam;
use crate::run::{Rgb, RunError, drawn_by};

/// Random patterns the clone first learns from.
const FIRST: usize = 32;
/// Patterns a round asks about.
const ASKED: usize = 6;
/// Views a pattern is looked at in.
const VIEWS: u32 = 6;
/// Images of the first round: with fewer nothing is searched.
pub const FIRST_ROUND: u64 = FIRST as u64 * VIEWS as u64;
/// Steps of training and of descent a round, and their rates.
const TRAINING: usize = 40;
pub const TRAINING_RATE: f64 = 1e-3;
const DESCENT: usize = 20;
const DESCENT_RATE: f64 = 0.02;
/// Patterns in a minibatch of the clone.
const MINIBATCH: usize = 32;
/// Standard deviation of the uniform noise about the pattern that a round asks about.
const SPREAD: f64 = 0.15;
const NOTED_EVERY: u32 = 4;
const CHANNELS: usize = 16;

/// The network that imitates renderer and detector: from a pattern to its score.
#[derive(Module, Debug)]
pub struct Clone2d {
    pub first: Conv2d,
    pub second: Conv2d,
    pub hidden: Linear,
    pub last: Linear,
}

impl Clone2d {
    pub fn new(cells: usize, device: &Device) -> Self {
        let conv = |channels| Conv2dConfig::new(channels, [3, 3]).init(device);
        // Two convolutions without padding take four cells off.
        let flat = 2 * CHANNELS * (cells - 4) * (cells - 4);
        Self {
            first: conv([3, CHANNELS]),
            second: conv([CHANNELS, 2 * CHANNELS]),
            hidden: LinearConfig::new(flat, 32).init(device),
            last: LinearConfig::new(32, 1).init(device),
        }
    }

    /// `patterns`: [N, 3, rows, columns], sRGB of 0 to 1; the result is [N, 1], before the sigmoid.
    pub fn forward(&self, patterns: Tensor<4>) -> Tensor<2> {
        let x = relu(self.first.forward(patterns - 0.5));
        let x: Tensor<2> = relu(self.second.forward(x)).flatten(1, 3);
        self.last.forward(relu(self.hidden.forward(x)))
    }
}

/// The mean binary cross-entropy between a clone's answers and scores.
pub fn cross_entropy(clone: &Clone2d, patterns: Tensor<4>, scores: Vec<f32>) -> Tensor<1> {
    let count = scores.len();
    let truth: Tensor<2> = Tensor::from_data(TensorData::new(scores, [count, 1]), &patterns.device());
    let logit = clone.forward(patterns);
    // relu(x) − x·t + ln(1 + e^−|x|): cross-entropy of a sigmoid that does not saturate.
    let soft = (logit.clone().abs().neg().exp() + 1.0).log();
    (relu(logit.clone()) - logit * truth + soft).mean()
}

/// What a clone has seen.
struct Answered {
    cells: Vec<Rgb>,
    score: f64,
}

/// Searches until the query budget is exhausted. The pattern must have six cells a side or more.
pub fn search(oracle: &mut BlackBox, config: &SearchConfig, device: &Device) -> Result<Vec<Rgb>, RunError> {
    let device = device.clone().autodiff();
    device.seed(config.seed);
    let side = config.cells as usize;
    let mut clone = Clone2d::new(side, &device);
    let mut optimiser = AdamConfig::new().init();
    let mut rng = drawn_by(config.seed, u32::MAX);
    let random = |rng: &mut rand_pcg::Pcg32| -> Vec<Rgb> {
        let mut cell = |_| std::array::from_fn(|_| rng.random());
        (0..side * side).map(&mut cell).collect()
    };
    let (mut seen, mut best) = (Vec::<Answered>::new(), random(&mut rng));
    let mut asking: Vec<Vec<Rgb>> = (0..FIRST).map(|_| random(&mut rng)).collect();
    for round in 0.. {
        let mut rng = drawn_by(config.seed, round);
        let Some(answers) = ask(oracle, config, round, asking)? else {
            break;
        };
        if let Some(found) = answers.iter().min_by(|a, b| a.score.total_cmp(&b.score)) {
            // After the first round the pattern itself was asked about first.
            let own = if round == 0 { found } else { &answers[0] };
            best.clone_from(&own.cells);
            if round % NOTED_EVERY == 0 {
                oracle.note(&best, Some(found.score))?;
            }
        }
        seen.extend(answers);
        clone = train(clone, &mut optimiser, &seen, &mut rng, &device);
        let next = descend(&clone, best.clone(), side, &device);
        // The pattern itself, and what is around it.
        let around = |rng: &mut rand_pcg::Pcg32| -> Vec<Rgb> {
            let mut noisy = |v: f64| (v + SPREAD * 3.0_f64.sqrt() * rng.random_range(-1.0..1.0)).clamp(0.0, 1.0);
            next.iter().map(|cell| cell.map(&mut noisy)).collect()
        };
        asking = vec![next.clone()];
        asking.extend((1..ASKED).map(|_| around(&mut rng)));
    }
    oracle.note(&best, None)?;
    Ok(best)
}

/// All of them in the same views; `None` when the query budget is exhausted.
fn ask(
    oracle: &mut BlackBox,
    config: &SearchConfig,
    round: u32,
    asking: Vec<Vec<Rgb>>,
) -> Result<Option<Vec<Answered>>, RunError> {
    let views = oracle.draws(VIEWS, round, &mut drawn_by(config.seed ^ 0xa5c, round));
    let mut answers = Vec::new();
    for cells in asking {
        match oracle.mean_score(&views, &cells)? {
            Some(score) => answers.push(Answered { cells, score }),
            None => return Ok(None),
        }
    }
    Ok(Some(answers))
}

/// Binary cross-entropy against the scores, the last answers always among them.
fn train(
    mut clone: Clone2d,
    optimiser: &mut ModuleOptimizer,
    seen: &[Answered],
    rng: &mut impl Rng,
    device: &Device,
) -> Clone2d {
    for _ in 0..TRAINING {
        let recent = seen.len().saturating_sub(ASKED)..seen.len();
        let random = (0..MINIBATCH.min(seen.len())).map(|_| rng.random_range(0..seen.len()));
        let chosen: Vec<&Answered> = recent.chain(random).map(|i| &seen[i]).collect();
        let patterns: Vec<&[Rgb]> = chosen.iter().map(|a| a.cells.as_slice()).collect();
        let scores: Vec<f32> = chosen.iter().map(|a| a.score as f32).collect();
        let loss = cross_entropy(&clone, input(&patterns, device), scores);
        let gradients = GradientsParams::from_grads(loss.backward(), &clone);
        clone = optimiser.step(TRAINING_RATE, clone, gradients);
    }
    clone
}

/// The pattern down the clone's score.
fn descend(clone: &Clone2d, mut cells: Vec<Rgb>, side: usize, device: &Device) -> Vec<Rgb> {
    let mut adam = Adam::new(cells.len());
    for _ in 0..DESCENT {
        let pattern = input(&[&cells], device).require_grad();
        let score = sigmoid(clone.forward(pattern.clone())).sum();
        let gradient = pattern.grad(&score.backward());
        let Some(values) = gradient.and_then(|g| g.into_data().try_to_vec::<f32>().ok()) else {
            break;
        };
        let plane = side * side;
        let of_cell = |i: usize| std::array::from_fn(|c| f64::from(values[c * plane + i]));
        let gradient: Vec<Rgb> = (0..plane).map(of_cell).collect();
        adam.step(&mut cells, &gradient, DESCENT_RATE, [0.0, 1.0]);
    }
    cells
}

/// [N, 3, side, side].
pub fn input(patterns: &[&[Rgb]], device: &Device) -> Tensor<4> {
    let cells = patterns.first().map_or(0, |p| p.len());
    let side = cells.isqrt();
    let mut values = Vec::with_capacity(3 * cells * patterns.len());
    for pattern in patterns {
        for channel in 0..3 {
            values.extend(pattern.iter().map(|cell| cell[channel] as f32));
        }
    }
    Tensor::from_data(TensorData::new(values, [patterns.len(), 3, side, side]), device)
}
