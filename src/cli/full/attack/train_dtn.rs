//! `scaleproof attack train-dtn`: a network that predicts the model in any paint from one image of the view.

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::render::hexes;
use crate::cli::answer::told;
use crate::cli::choice::one_of;
use crate::cli::{CommandResult, Result, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::run::{TrainingBudget, train};
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan, TrainingProgress};
use scaleproof_frames::surrogate::dtn::{Architecture, Encoder, LEAST_WIDTH_PX, Transformer, file};

/// Train DTN (or NTR) on frames in flat colours; a file that is there already is trained further
#[derive(clap::Args)]
pub(in crate::cli) struct TrainArgs {
    /// Folders of frames; with linear light in three flat colours a view, all colours are made of those
    #[arg(value_name = "FRAMES", required = true)]
    frames: Vec<PathBuf>,
    /// Frames to validate on; without, a place and every fourth azimuth are kept back
    #[arg(long, value_name = "FRAMES")]
    validation: Option<PathBuf>,
    #[arg(long, default_value = "resnet", value_parser = one_of(Encoder::ALL.map(|encoder| (encoder, encoder.name()))))]
    encoder: Encoder,
    /// k: how often the encoder halves the image
    #[arg(long, value_name = "K", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=Architecture::MAX_DEPTH as i64))]
    depth: u8,
    /// DTN's or, multiply-add, that of ACTIVE's NTR
    #[arg(long, default_value = "texture", value_parser = one_of(Transformer::ALL.map(|transformer| (transformer, transformer.name()))))]
    transformer: Transformer,
    /// Flat colours of the image it starts from, as hex; several: one of them at random
    #[arg(long, value_name = "HEX", num_args = 1..=16, default_values = ["808080"])]
    reference: Vec<String>,
    /// Reduce the frames to this width [default: the first folder's]
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(i64::from(LEAST_WIDTH_PX)..=4096))]
    width_px: Option<u32>,
    /// Times all training views, with those of earlier runs
    #[arg(long, value_name = "N", default_value_t = 25, conflicts_with = "seconds", value_parser = clap::value_parser!(u64).range(1..))]
    epochs: u64,
    /// Train for so long instead, with the time of earlier runs
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The network, saved every half minute
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &TrainArgs, out: &mut dyn Write) -> CommandResult {
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

/// `attack train-dtn --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct TrainedNetwork<'a> {
    /// The path of the network.
    file: &'a Path,
    /// Its architecture.
    network: String,
    /// Views to learn from.
    training_views: usize,
    /// Views kept back.
    validation_views: usize,
    /// How they were chosen.
    split: &'a str,
    history: &'a [TrainingProgress],
}

fn table(args: &TrainArgs, trainer: &Trainer, set: &TrainingSet) -> String {
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

fn frames(args: &TrainArgs, references: &[[u8; 3]]) -> Result<TrainingSet> {
    let mut folders = FrameSet::open_all(args.frames.iter().chain(&args.validation))?;
    let validation = args.validation.as_ref().and_then(|_| folders.pop());
    let width = args.width_px.unwrap_or(folders[0].list.size_px[0]);
    let views = folders.iter().chain(&validation).map(FrameSet::view_count).sum();
    let read = progress::frames("reading views", views)
        .during(|bar| TrainingSet::read(&folders, validation.as_ref(), width, references, || bar.inc(1)));
    Ok(read?)
}

/// At most about ten lines, the last among them.
fn thinned<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let every = all.len().div_ceil(10).max(1);
    let skip = (all.len() + every - 1) % every;
    all.iter().skip(skip).step_by(every)
}
