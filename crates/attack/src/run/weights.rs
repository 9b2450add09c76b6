//! The weight of each detector: alike, or the greater the better it still sees the model.

use serde::{Deserialize, Serialize};

/// Objective of several detectors' losses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Against {
    /// Their mean.
    #[default]
    Mean,
    /// The loss of the detector that still sees the model best: min–max (Wang et al., NeurIPS 2021, "Adversarial Attack Generation Empowered by
    /// Min-Max Optimization"), with weights of the softmax of the losses of the last steps instead of steps in the weights.
    Worst,
}

impl Against {
    /// Both objectives, the default first.
    pub const ALL: [Self; 2] = [Self::Mean, Self::Worst];

    pub fn name(self) -> &'static str {
        ["mean", "worst"][self as usize]
    }
}

/// Share of the last step in a running mean of the losses.
const NEWEST: f64 = 0.1;

/// Difference of losses whose weights differ by the factor e. Losses go up to some 10 (`ln(odds / odds of the floor)`).
pub const TEMPERATURE: f64 = 0.5;

/// Running means of the losses, and weights by them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectorWeights {
    losses: Vec<f64>,
    steps: u32,
}

impl DetectorWeights {
    pub fn new(detectors: usize) -> Self {
        Self {
            losses: vec![0.0; detectors],
            steps: 0,
        }
    }

    /// Returns the weights of a step; their mean is 1.
    pub fn weights(&self, against: Against) -> Vec<f64> {
        let highest = self.losses.iter().copied().fold(0.0, f64::max);
        let raw: Vec<f64> = match against {
            Against::Mean => vec![1.0; self.losses.len()],
            Against::Worst => {
                let softmax = |loss: &f64| ((loss - highest) / TEMPERATURE).exp();
                self.losses.iter().map(softmax).collect()
            }
        };
        let mean = raw.iter().sum::<f64>() / raw.len().max(1) as f64;
        raw.iter().map(|weight| weight / mean).collect()
    }

    pub fn observe(&mut self, losses: &[f64]) {
        // The mean of all so far, until that forgets.
        self.steps = self.steps.saturating_add(1);
        let share = NEWEST.max(1.0 / f64::from(self.steps));
        for (mean, loss) in self.losses.iter_mut().zip(losses) {
            *mean += share * (loss - *mean);
        }
    }
}
