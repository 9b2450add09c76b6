//! `scaleproof attack`: frames, the models that predict them, and patterns against detectors.

mod baseline;
mod chart;
mod colours;
mod demo;
mod evaluate;
mod history;
mod import;
mod judge;
mod on_frames;
mod photos;
mod render;
mod run;
mod train_dtn;

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::CommandResult;
use crate::cli::answer::{Named, named, told};

pub(in crate::cli) use render::{azimuths, size};
use scaleproof_core::spelling::count;
use scaleproof_frames::{FrameSet, LIST};
use scaleproof_gradients::WhiteBox;

#[derive(Subcommand)]
pub(in crate::cli) enum Command {
    Render(Box<render::RenderArgs>),
    Import(import::ImportArgs),
    Photos(photos::PhotosArgs),
    Check(CheckArgs),
    Colours(colours::ColoursArgs),
    Chart(chart::ChartArgs),
    Evaluate(Box<evaluate::EvaluateArgs>),
    TrainDtn(train_dtn::TrainArgs),
    Run(Box<run::RunArgs>),
    /// Make the patterns an attack must beat, and judge them by the same views
    #[command(subcommand)]
    Baseline(Box<baseline::Method>),
    Judge(Box<judge::JudgeArgs>),
    History(history::HistoryArgs),
    Demo(demo::DemoArgs),
}

/// Read every image of frames and hold them against their list
#[derive(clap::Args)]
pub(in crate::cli) struct CheckArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
    /// Print a JSON object instead of the sentence
    #[arg(long)]
    json: bool,
}

/// Detectors, and the name and hash of each.
type WhiteBoxes = (Vec<Box<dyn WhiteBox>>, Vec<String>);

/// Runs `scaleproof attack …`.
pub(in crate::cli) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Render(args) => render::run(&args, out),
        Command::Import(args) => import::run(&args, out),
        Command::Photos(args) => photos::run(&args, out),
        Command::Check(args) => check(&args, out),
        Command::Colours(args) => colours::run(&args, out),
        Command::Chart(args) => chart::run(&args, out),
        Command::Evaluate(args) => evaluate::run(&args, out),
        Command::TrainDtn(args) => train_dtn::run(&args, out),
        Command::Run(args) => run::run(&args, out),
        Command::Baseline(method) => baseline::run(*method, out),
        Command::Judge(args) => judge::run(&args, out),
        Command::History(args) => history::run(&args, out),
        Command::Demo(args) => demo::run(&args, out),
    }
}

/// `attack render --json`, `attack import --json` and `attack colours --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct WrittenFrames {
    /// The path of `frames.json`.
    file: PathBuf,
    /// How many frames it lists.
    frames: usize,
}

/// `attack check --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct CheckedFrames {
    /// How many there are, all whole.
    frames: usize,
    /// Their width and height.
    size_px: [u32; 2],
}

/// Where frames will be listed in a folder that has none yet.
fn new_list(folder: &Path) -> Result<PathBuf, String> {
    let list = folder.join(LIST);
    if list.exists() {
        Err(format!("{} is there already; give another folder", list.display()))
    } else {
        Ok(list)
    }
}

/// What a command that wrote frames ends with.
fn say_frames(list: &Path, frames: usize, json: bool, out: &mut dyn Write) -> CommandResult {
    let words = format!("{}: {}", list.display(), count(frames, "frame"));
    let file = list.to_owned();
    told(json, WrittenFrames { file, frames }, words, out)
}

fn check(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    set.list.frames.iter().try_for_each(|frame| set.check_images(frame))?;
    let (size_px, frames) = (set.list.size_px, set.list.frames.len());
    let [width, height] = size_px;
    let words = format!("{frames} frames of {width}×{height} px are whole");
    told(args.json, CheckedFrames { frames, size_px }, words, out)
}

pub(in crate::cli) fn schemas() -> Vec<Named> {
    vec![
        named::<CheckedFrames>("attack-check"),
        named::<evaluate::Evaluated>("attack-evaluate"),
        named::<WrittenFrames>("attack-frames"),
        named::<history::Histories>("attack-history"),
        named::<judge::Judgement>("attack-judge"),
        named::<photos::FramesOfPhotos>("attack-photos"),
        named::<on_frames::Made>("attack-run"),
        named::<train_dtn::TrainedNetwork>("attack-train-dtn"),
        named::<scaleproof_frames::surrogate::chart::Numbers>("renderers"),
    ]
}
