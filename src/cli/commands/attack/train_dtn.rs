//! `scaleproof attack train-dtn`: a network that predicts the model in any paint from one image of the view.

use std::io::Write;

use crate::cli::answer::told;
use crate::cli::args::attack::train_dtn::TrainArgs;
use crate::cli::print::attack::train_dtn::{TrainedNetwork, table};
use crate::cli::resolve::attack::render::hexes;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::run::{TrainingBudget, train};
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan};
use scaleproof_frames::surrogate::dtn::{Architecture, file};

pub fn run(args: &TrainArgs, out: &mut dyn Write) -> CommandResult {
    if args.seconds.is_some_and(|s| !(s > 0.0 && s.is_finite())) {
        return Err("--seconds must be above 0".into());
    }
    files::check_file_writable(&args.output)?;
    files::inputs::own(&args.output);
    let known = args.output.exists().then(|| file::load(&args.output)).transpose()?;
    let references = hexes(&args.reference)?;
    let set = frames(args, &references)?;
    let plan = TrainingPlan {
        architecture: Architecture {
            encoder: args.encoder,
            depth: usize::from(args.depth),
            transformer: args.transformer,
        },
        references,
        seed: args.seed,
        data_sha256: set.sha256.clone(),
    };
    let mut trainer = Trainer::begin(plan, known, &args.output)?;
    let (budget, length) = match args.seconds {
        Some(seconds) => (TrainingBudget::Seconds(seconds), seconds.ceil() as u64),
        None => (
            TrainingBudget::Epochs(args.epochs),
            args.epochs.saturating_mul(Trainer::steps_an_epoch(&set)),
        ),
    };
    progress::training(args.seconds.is_some(), length).during(|bar| {
        train(&mut trainer, &set, budget, &args.output, |trainer, loss| {
            bar.set_position(if args.seconds.is_some() {
                trainer.seconds as u64
            } else {
                trainer.steps
            });
            let mse = trainer.history.last().and_then(|p| p.validation_mse);
            let mse = mse.map_or(String::new(), |m| format!(", MSE {m:.5}"));
            bar.set_message(format!("loss {loss:.4}{mse}"));
        })
    })?;
    let words = table(args, &trainer, &set);
    let trained = TrainedNetwork {
        file: &args.output,
        network: trainer.network().architecture.name(),
        training_views: set.training.len(),
        validation_views: set.validation.len(),
        split: &set.split,
        history: &trainer.history,
    };
    told(args.json, &trained, words, out)
}

pub fn frames(args: &TrainArgs, references: &[[u8; 3]]) -> Result<TrainingSet> {
    let mut folders = FrameSet::open_all(args.frames.iter().chain(&args.validation))?;
    let validation = args.validation.as_ref().and_then(|_| folders.pop());
    let width = args.width_px.unwrap_or(folders[0].list.size_px[0]);
    let views = folders.iter().chain(&validation).map(FrameSet::view_count).sum();
    let read = progress::frames("reading views", views)
        .during(|bar| TrainingSet::read(&folders, validation.as_ref(), width, references, || bar.inc(1)));
    Ok(read?)
}
