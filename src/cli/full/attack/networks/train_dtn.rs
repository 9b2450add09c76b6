//! `scaleproof attack train-dtn`: a network that predicts the model in any paint from one image of the view.

use scaleproof_frames::surrogate::dtn::training::TrainingProgress;
use schemars::JsonSchema;
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::path::PathBuf;

use crate::cli::answer::answer;
use crate::cli::full::attack::device::OnDevice;
use crate::cli::full::attack::on_frames::open_frames;
use crate::cli::full::attack::render::hex;
use crate::cli::{CommandResult, Outcome, progress};
use scaleproof_core::files;
use scaleproof_frames::frames::views;
use scaleproof_frames::surrogate::dtn::data::TrainingSet;
use scaleproof_frames::surrogate::dtn::run::{TrainingBudget, train};
use scaleproof_frames::surrogate::dtn::training::{Trainer, TrainingPlan};
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
    /// resnet, densenet or convnet
    #[arg(long, default_value = "resnet", value_parser = encoder)]
    encoder: Encoder,
    /// k: how often the encoder halves the image
    #[arg(long, value_name = "K", default_value_t = 4, value_parser = clap::value_parser!(u8).range(1..=Architecture::MAX_DEPTH as i64))]
    depth: u8,
    /// texture (DTN) or multiply-add (NTR of ACTIVE)
    #[arg(long, default_value = "texture", value_parser = transformer)]
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
    #[command(flatten)]
    on: OnDevice,
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
    let known = if args.output.exists() {
        Some(file::load(&args.output)?)
    } else {
        None
    };
    let device = args.on.device.open()?;
    let set = frames(args)?;
    let plan = plan(args, &set)?;
    let mut trainer = Trainer::begin(plan, known, &args.output, device)?;
    let (budget, length) = match args.seconds {
        Some(seconds) => (TrainingBudget::Seconds(seconds), seconds.ceil() as u64),
        None => (
            TrainingBudget::Epochs(args.epochs),
            args.epochs.saturating_mul(Trainer::steps_an_epoch(&set)),
        ),
    };
    let bar = progress::training(args.seconds.is_some(), length);
    train(&mut trainer, &set, budget, &args.output, |trainer, loss| {
        bar.set_position(if args.seconds.is_some() {
            trainer.seconds as u64
        } else {
            trainer.steps
        });
        let mse = trainer.history.last().and_then(|p| p.validation_mse);
        bar.set_message(format!(
            "loss {loss:.4}{}",
            mse.map_or(String::new(), |m| format!(", MSE {m:.5}"))
        ));
    })?;
    bar.finish_and_clear();
    if args.json {
        answer(&summary(args, &trainer, &set), out)?
    } else {
        table(args, &trainer, &set, out)?
    }
    Ok(Outcome::Done)
}

/// `--json`.
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

fn summary<'a>(args: &'a TrainArgs, trainer: &'a Trainer, set: &'a TrainingSet) -> TrainedNetwork<'a> {
    TrainedNetwork {
        file: &args.output,
        network: trainer.network().architecture.name(),
        training_views: set.training.len(),
        validation_views: set.validation.len(),
        split: &set.split,
        history: &trainer.history,
    }
}

fn table(args: &TrainArgs, trainer: &Trainer, set: &TrainingSet, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{}: {} views to learn from, {} to validate on ({})",
        trainer.network().architecture.name(),
        set.training.len(),
        set.validation.len(),
        set.split
    )?;
    writeln!(
        out,
        "{:>8} {:>9} {:>8} {:>15}",
        "step", "seconds", "loss", "validation MSE"
    )?;
    for p in thinned(&trainer.history) {
        let mse = p.validation_mse.map_or("–".to_owned(), |m| format!("{m:.6}"));
        writeln!(out, "{:>8} {:>9.1} {:>8.4} {mse:>15}", p.step, p.seconds, p.loss)?;
    }
    writeln!(out, "{}", args.output.display())
}

fn frames(args: &TrainArgs) -> Result<TrainingSet, Box<dyn Error>> {
    let mut folders = open_frames(args.frames.iter().chain(&args.validation))?;
    let validation = args.validation.as_ref().and_then(|_| folders.pop());
    let width = args.width_px.unwrap_or(folders[0].list.size_px[0]);
    let count: usize = folders
        .iter()
        .chain(&validation)
        .map(|set| views(&set.list.frames).len())
        .sum();
    let bar = progress::frames("reading views", count);
    let set = TrainingSet::read(&folders, validation.as_ref(), width, &references(args)?, || bar.inc(1))?;
    bar.finish_and_clear();
    Ok(set)
}

fn references(args: &TrainArgs) -> Result<Vec<[u8; 3]>, Box<dyn Error>> {
    args.reference.iter().map(|text| hex(text)).collect()
}

fn plan(args: &TrainArgs, set: &TrainingSet) -> Result<TrainingPlan, Box<dyn Error>> {
    Ok(TrainingPlan {
        architecture: Architecture {
            encoder: args.encoder,
            depth: usize::from(args.depth),
            transformer: args.transformer,
        },
        references: references(args)?,
        seed: args.seed,
        data_sha256: set.sha256.clone(),
    })
}

/// At most about ten lines, the last among them.
fn thinned<T>(all: &[T]) -> impl Iterator<Item = &T> {
    let every = all.len().div_ceil(10).max(1);
    let skip = (all.len() + every - 1) % every;
    all.iter().skip(skip).step_by(every)
}

fn encoder(text: &str) -> Result<Encoder, String> {
    let found = Encoder::ALL.into_iter().find(|e| e.name() == text);
    found.ok_or_else(|| "resnet, densenet and convnet are the encoders".to_owned())
}

fn transformer(text: &str) -> Result<Transformer, String> {
    let found = Transformer::ALL.into_iter().find(|t| t.name() == text);
    found.ok_or_else(|| "texture and multiply-add are the transformers".to_owned())
}
