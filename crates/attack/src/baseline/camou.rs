//! CAMOU (Zhang et al., ICLR 2019): a clone network learns what renderer and detector say of patterns, and the pattern
//! goes down the clone's gradient; the two alternate, and the clone learns next from the patterns of that descent.
//!
//! The paper's clone sees the pattern tiled on a view; ours sees the pattern alone and imitates the mean score over a
//! minibatch of views, which is the expectation that the paper's loss takes.

use rand::{Rng, RngExt};

use super::{BlackBox, SearchConfig};
use crate::AttackError;
use crate::run::adam::CellMoments;
use crate::run::{Rgb, drawn_by};
use scaleproof_gradients::adam::Adam;
use scaleproof_gradients::layers::learning::{By, Kernel, Network};

/// Random patterns that the clone first learns from.
const FIRST: usize = 32;
/// Patterns scored in a round.
const CANDIDATES: usize = 6;
/// Views that a pattern is scored in.
const VIEWS: u32 = 6;
/// Queries of the first round: with fewer nothing is searched.
pub const FIRST_ROUND: u64 = FIRST as u64 * VIEWS as u64;
/// Steps of training and of descent in a round, with their learning rates.
const TRAINING: usize = 40;
const ADAM: Adam = Adam {
    learning_rate: 1e-3,
    epsilon: 1e-5,
};
const DESCENT: usize = 20;
const DESCENT_RATE: f64 = 0.02;
/// Patterns in a minibatch of the clone.
const MINIBATCH: usize = 32;
/// Standard deviation of the uniform noise of candidates about the pattern.
const SPREAD: f64 = 0.15;
const NOTED_EVERY: u32 = 4;
const CHANNELS: usize = 16;

/// Units of the layer before the last.
const HIDDEN: usize = 32;
const KERNEL: Kernel = Kernel {
    size: 3,
    stride: 1,
    padding: 0,
};

/// The network that imitates renderer and detector: from a pattern to its score. Two convolutions, without padding, and two linear layers.
#[derive(Debug, Clone)]
pub struct Clone2d {
    side: usize,
    /// Weights (outputs × inputs) and biases of each layer in turn.
    pub lists: Vec<Vec<f32>>,
    /// Adam's moments of each list.
    moments: Vec<[Vec<f32>; 2]>,
    steps: i32,
}

impl Clone2d {
    /// Weights and biases are uniform within 1/√inputs (Kaiming's law with a = √5).
    pub fn new(side: usize, rng: &mut impl Rng) -> Self {
        // Two convolutions take four cells off.
        let flat = 2 * CHANNELS * (side - 4) * (side - 4);
        let layers = [
            (3 * 9, CHANNELS),
            (CHANNELS * 9, 2 * CHANNELS),
            (flat, HIDDEN),
            (HIDDEN, 1),
        ];
        let mut lists = Vec::new();
        for (inputs, outputs) in layers {
            let most = 1.0 / (inputs as f32).sqrt();
            let mut list = |count| Vec::from_iter((0..count).map(|_| rng.random_range(-most..most)));
            lists.extend([list(inputs * outputs), list(outputs)]);
        }
        let zeros = |list: &Vec<f32>| [vec![0.0; list.len()], vec![0.0; list.len()]];
        Self {
            side,
            moments: lists.iter().map(zeros).collect(),
            lists,
            steps: 0,
        }
    }

    /// Builds the network; its output is the score before the sigmoid.
    fn network(&self, by: By) -> Network {
        let (mut network, mut x) = Network::new(3, [self.side; 2], by);
        for (layer, lists) in self.lists.chunks_exact(2).enumerate() {
            let lists = [&lists[0][..], &lists[1]];
            if layer > 0 {
                x = network.relu(x);
            }
            x = match layer {
                0 | 1 => network.convolution(x, KERNEL, lists),
                _ => network.linear(x, lists),
            };
        }
        network
    }

    /// Returns the mean binary cross-entropy between the clone's scores of patterns and the true ones, and its gradients with respect to each list.
    pub fn loss_and_gradient(&self, samples: &[(&[Rgb], f64)]) -> (f64, Vec<Vec<f32>>) {
        let share = 1.0 / samples.len() as f64;
        let loss = |(_, score): &(&[Rgb], f64), logit: &[f32]| {
            let x = f64::from(logit[0]);
            // −t ln σ(x) − (1 − t) ln (1 − σ(x)), without a sigmoid that saturates.
            let loss = x.max(0.0) - x * score + (-x.abs()).exp().ln_1p();
            (share * loss, vec![(share * (sigmoid(x) - score)) as f32])
        };
        let network = self.network(By::Weights);
        network.loss_and_derivatives(samples, |(cells, _)| input(cells), loss)
    }

    /// Takes one step of training; returns the loss before it.
    pub fn step(&mut self, samples: &[(&[Rgb], f64)]) -> f64 {
        let (loss, gradients) = self.loss_and_gradient(samples);
        self.steps = self.steps.saturating_add(1);
        for ((list, moments), gradient) in self.lists.iter_mut().zip(&mut self.moments).zip(&gradients) {
            ADAM.step(self.steps, list, gradient, moments.each_mut().map(Vec::as_mut_slice));
        }
        loss
    }

    /// Returns the score of a pattern, and its gradient with respect to the cells.
    pub fn score_and_gradient(&self, cells: &[Rgb]) -> (f64, Vec<Rgb>) {
        let score = |_: &&[Rgb], logit: &[f32]| {
            let score = sigmoid(f64::from(logit[0]));
            (score, vec![(score * (1.0 - score)) as f32])
        };
        let network = self.network(By::Image);
        let (score, gradients) = network.loss_and_derivatives(&[cells], |cells| input(cells), score);
        let of_cell = |i: usize| std::array::from_fn(|c| f64::from(gradients[0][c * cells.len() + i]));
        (score, (0..cells.len()).map(of_cell).collect())
    }
}

fn sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// Returns the input of the network for a pattern: channel by channel, about 0.
fn input(cells: &[Rgb]) -> Vec<f32> {
    let channel = |c: usize| cells.iter().map(move |cell| cell[c] as f32 - 0.5);
    (0..3).flat_map(channel).collect()
}

/// Pattern with its score.
struct Scored {
    cells: Vec<Rgb>,
    score: f64,
}

/// Searches until the query budget is exhausted. The pattern must have six cells a side or more.
pub fn search(oracle: &mut BlackBox, config: &SearchConfig) -> Result<Vec<Rgb>, AttackError> {
    let side = config.cells as usize;
    let mut clone = Clone2d::new(side, &mut drawn_by(config.seed, u32::MAX - 1));
    let mut rng = drawn_by(config.seed, u32::MAX);
    let random = |rng: &mut rand_pcg::Pcg32| -> Vec<Rgb> {
        let mut cell = |_| std::array::from_fn(|_| rng.random());
        (0..side * side).map(&mut cell).collect()
    };
    let (mut seen, mut best) = (Vec::<Scored>::new(), random(&mut rng));
    let mut candidates: Vec<Vec<Rgb>> = (0..FIRST).map(|_| random(&mut rng)).collect();
    for round in 0.. {
        let mut rng = drawn_by(config.seed, round);
        let Some(answers) = score_all(oracle, config, round, candidates)? else {
            break;
        };
        if let Some(found) = answers.iter().min_by(|a, b| a.score.total_cmp(&b.score)) {
            // After the first round the first candidate is the pattern itself.
            let own = if round == 0 { found } else { &answers[0] };
            best.clone_from(&own.cells);
            if round % NOTED_EVERY == 0 {
                oracle.note(&best, Some(found.score))?;
            }
        }
        seen.extend(answers);
        train(&mut clone, &seen, &mut rng);
        let next = descend(&clone, best.clone());
        // The pattern itself, and what is around it.
        let around = |rng: &mut rand_pcg::Pcg32| -> Vec<Rgb> {
            let mut noisy = |v: f64| (v + SPREAD * 3.0_f64.sqrt() * rng.random_range(-1.0..1.0)).clamp(0.0, 1.0);
            next.iter().map(|cell| cell.map(&mut noisy)).collect()
        };
        candidates = vec![next.clone()];
        candidates.extend((1..CANDIDATES).map(|_| around(&mut rng)));
    }
    oracle.note(&best, None)?;
    Ok(best)
}

/// Scores patterns in the same views; `None` when the query budget is exhausted.
fn score_all(
    oracle: &mut BlackBox,
    config: &SearchConfig,
    round: u32,
    candidates: Vec<Vec<Rgb>>,
) -> Result<Option<Vec<Scored>>, AttackError> {
    let views = oracle.draws(VIEWS, round, &mut drawn_by(config.seed ^ 0xa5c, round));
    let mut answers = Vec::new();
    for cells in candidates {
        match oracle.mean_score(&views, &cells)? {
            Some(score) => answers.push(Scored { cells, score }),
            None => return Ok(None),
        }
    }
    Ok(Some(answers))
}

/// Trains the clone on scored patterns, the last ones always among them.
fn train(clone: &mut Clone2d, seen: &[Scored], rng: &mut impl Rng) {
    for _ in 0..TRAINING {
        let recent = seen.len().saturating_sub(CANDIDATES)..seen.len();
        let random = (0..MINIBATCH.min(seen.len())).map(|_| rng.random_range(0..seen.len()));
        let chosen = recent.chain(random).map(|i| (seen[i].cells.as_slice(), seen[i].score));
        clone.step(&Vec::from_iter(chosen));
    }
}

/// Moves a pattern down the gradient of the clone's score.
fn descend(clone: &Clone2d, mut cells: Vec<Rgb>) -> Vec<Rgb> {
    let mut moments = CellMoments::new(cells.len());
    for _ in 0..DESCENT {
        let (_, gradient) = clone.score_and_gradient(&cells);
        moments.step(&mut cells, &gradient, DESCENT_RATE, [0.0, 1.0]);
    }
    cells
}
