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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_the_bottom_of_a_bowl_and_stops_at_the_clip() {
        let (bottom, mut cells) = ([0.3, 0.8, 1.7], vec![[0.5; 3]]);
        let mut adam = Adam::new(1);
        for _ in 0..2000 {
            let gradient = [std::array::from_fn(|c| 2.0 * (cells[0][c] - bottom[c]))];
            adam.step(&mut cells, &gradient, 0.01, [0.0, 1.0]);
        }
        for (found, wanted) in cells[0].iter().zip([0.3, 0.8, 1.0]) {
            assert!((found - wanted).abs() < 1e-3, "{found} {wanted}");
        }
    }

    #[test]
    fn the_first_step_is_the_learning_rate_whatever_the_gradient() {
        let mut cells = vec![[0.5; 3]];
        Adam::new(1).step(&mut cells, &[[1e-3, -40.0, 0.0]], 0.02, [0.0, 1.0]);
        let [a, b, c] = cells[0];
        assert!((a - 0.48).abs() < 1e-4 && (b - 0.52).abs() < 1e-4 && c == 0.5);
    }
}
