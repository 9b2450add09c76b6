//! Adam's moments of cells, which a hard clip bounds.

use scaleproof_gradients::adam::Adam;
use serde::{Deserialize, Serialize};

use super::cells::Rgb;

const EPSILON: f64 = 1e-8;

/// Adam's moments of cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellMoments {
    steps: i32,
    first: Vec<Rgb>,
    second: Vec<Rgb>,
}

impl CellMoments {
    pub fn new(cells: usize) -> Self {
        Self {
            steps: 0,
            first: vec![[0.0; 3]; cells],
            second: vec![[0.0; 3]; cells],
        }
    }

    /// Takes a step against the gradient; cells stay between `low` and `high`.
    pub fn step(&mut self, cells: &mut [Rgb], gradient: &[Rgb], learning_rate: f64, [low, high]: [f64; 2]) {
        self.steps = self.steps.saturating_add(1);
        let adam = Adam {
            learning_rate,
            epsilon: EPSILON,
        };
        let cells = cells.as_flattened_mut();
        let moments = [&mut self.first, &mut self.second].map(|m| m.as_flattened_mut());
        adam.step(self.steps, cells, gradient.as_flattened(), moments);
        cells.iter_mut().for_each(|v| *v = v.clamp(low, high));
    }
}
