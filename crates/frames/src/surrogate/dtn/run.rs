//! Training within a budget, saved every half minute.

use std::path::Path;
use std::time::Instant;

use super::data::TrainingSet;
use super::file;
use super::training::{Trainer, VALIDATE_EVERY};
use crate::FramesError;

/// Longest training time between two saves.
const SAVE_EVERY_SECONDS: f64 = 30.0;

/// End of training, over all its runs together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TrainingBudget {
    /// The number of passes over all training views.
    Epochs(u64),
    /// The time spent on training, s: then the result depends on the machine.
    Seconds(f64),
}

impl TrainingBudget {
    fn is_spent(self, trainer: &Trainer, set: &TrainingSet) -> bool {
        match self {
            Self::Epochs(epochs) => trainer.steps >= epochs.saturating_mul(Trainer::steps_an_epoch(set)),
            Self::Seconds(seconds) => trainer.seconds >= seconds,
        }
    }
}

/// Trains until the budget is spent and saves at the end and every half minute. `on_step` is called with each step's loss.
pub fn train(
    trainer: &mut Trainer,
    set: &TrainingSet,
    budget: TrainingBudget,
    path: &Path,
    mut on_step: impl FnMut(&Trainer, f64),
) -> Result<(), FramesError> {
    let mut saved_at = trainer.seconds;
    while !budget.is_spent(trainer, set) {
        let start = Instant::now();
        let loss = trainer.step(set)?;
        trainer.seconds += start.elapsed().as_secs_f64();
        if trainer.steps.is_multiple_of(VALIDATE_EVERY) {
            trainer.validate(set);
        }
        on_step(trainer, loss);
        if trainer.seconds - saved_at > SAVE_EVERY_SECONDS {
            saved_at = trainer.seconds;
            file::save(trainer, path)?;
        }
    }
    if trainer.history.last().is_none_or(|last| last.step != trainer.steps) {
        trainer.validate(set);
    }
    file::save(trainer, path)
}
