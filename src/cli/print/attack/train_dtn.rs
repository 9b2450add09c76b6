//! Results of `attack train-dtn`, as JSON and in words.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::args::attack::train_dtn::TrainArgs;
use scaleproof_core::spelling::count;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingProgress};

/// `attack train-dtn --json`.
#[derive(Serialize, JsonSchema)]
pub struct TrainedNetwork<'a> {
    /// The path of the network.
    pub file: &'a Path,
    /// Its architecture.
    pub network: String,
    /// Views to learn from.
    pub training_views: usize,
    /// Views kept back.
    pub validation_views: usize,
    /// How they were chosen.
    pub split: &'a str,
    pub history: &'a [TrainingProgress],
}

pub fn table(args: &TrainArgs, trainer: &Trainer, set: &TrainingSet) -> String {
    let mut text = format!(
        "{}: {} to learn from, {} to validate on ({})\n{:>8} {:>9} {:>8} {:>15}\n",
        trainer.network().architecture.name(),
        count(set.training.len(), "view"),
        set.validation.len(),
        set.split,
        "step",
        "seconds",
        "loss",
        "validation MSE"
    );
    for p in thinned(&trainer.history) {
        let mse = p.validation_mse.map_or("–".to_owned(), |m| format!("{m:.6}"));
        text += &format!("{:>8} {:>9.1} {:>8.4} {mse:>15}\n", p.step, p.seconds, p.loss);
    }
    text + &args.output.display().to_string()
}

/// At most about ten lines, the last among them.
pub fn thinned<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let every = all.len().div_ceil(10).max(1);
    let skip = (all.len() + every - 1) % every;
    all.iter().skip(skip).step_by(every)
}
