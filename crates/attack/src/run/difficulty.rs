//! The choice of a step's views: each in turn, and some for how well the model is still seen in them.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use super::draw::{batch, drawn_by};

/// Last loss in each view; a view without one counts as the highest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Difficulty {
    losses: Vec<Option<f64>>,
}

impl Difficulty {
    pub fn new(views: usize) -> Self {
        Self {
            losses: vec![None; views],
        }
    }

    pub fn observe(&mut self, view: usize, loss: f64) {
        self.losses[view] = Some(loss);
    }

    /// Chooses `size` views of a step, of which a share `hard` is drawn with probabilities as their losses; the others come in turn.
    pub fn batch(&self, views: &[usize], size: u32, hard: f64, seed: u64, step: u32) -> Vec<usize> {
        let size = size.min(views.len() as u32);
        let drawn = (hard * f64::from(size)).round() as u32;
        let mut chosen = batch(views, size - drawn, seed, step);
        let highest = self.losses.iter().flatten().copied().fold(0.0, f64::max);
        let weight = |view: &usize| self.losses[*view].unwrap_or(highest).max(1e-3);
        let mut rng = drawn_by(seed ^ 0x4a7d, step);
        for _ in 0..drawn {
            let left: Vec<usize> = views.iter().copied().filter(|view| !chosen.contains(view)).collect();
            let mut at = rng.random::<f64>() * left.iter().map(weight).sum::<f64>();
            let found = left.iter().find(|view| {
                at -= weight(view);
                at < 0.0
            });
            chosen.extend(found.or(left.last()));
        }
        chosen
    }
}
