//! Adam (Kingma & Ba, ICLR 2015, algorithm 1) on cells, with a hard clip.

use serde::{Deserialize, Serialize};

use super::Rgb;

const BETA: [f64; 2] = [0.9, 0.999];
const EPSILON: f64 = 1e-8;

/// The moments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    steps: i32,
    first: Vec<Rgb>,
    second: Vec<Rgb>,
}

impl Adam {
    pub fn new(cells: usize) -> Self {
        Self {
            steps: 0,
            first: vec![[0.0; 3]; cells],
            second: vec![[0.0; 3]; cells],
        }
    }

    /// One step against the gradient; cells stay between `low` and `high`.
    pub fn step(&mut self, cells: &mut [Rgb], gradient: &[Rgb], learning_rate: f64, [low, high]: [f64; 2]) {
        self.steps = self.steps.saturating_add(1);
        let unbias = BETA.map(|beta| 1.0 - beta.powi(self.steps));
        for (i, g) in gradient.iter().enumerate() {
            for c in 0..3 {
                let (m, v) = (&mut self.first[i][c], &mut self.second[i][c]);
                *m = BETA[0] * *m + (1.0 - BETA[0]) * g[c];
                *v = BETA[1] * *v + (1.0 - BETA[1]) * g[c] * g[c];
                let by = learning_rate * (*m / unbias[0]) / ((*v / unbias[1]).sqrt() + EPSILON);
                cells[i][c] = (cells[i][c] - by).clamp(low, high);
            }
        }
    }
}
