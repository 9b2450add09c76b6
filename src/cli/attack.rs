//! `scaleproof attack`: frames, and the models that predict them.

mod chart;
mod colours;
mod evaluate;
mod import;
mod render;
#[cfg(feature = "attack")]
mod train_dtn;

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;

use super::{CommandResult, Outcome, detectors, print, progress, score};
use crate::attack::frames::FrameSet;

/// Frames of a painted model, and models that predict the model in any paint
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Render(Box<render::RenderArgs>),
    Import(import::ImportArgs),
    Check(CheckArgs),
    Colours(colours::ColoursArgs),
    Chart(chart::ChartArgs),
    Evaluate(Box<evaluate::EvaluateArgs>),
    #[cfg(feature = "attack")]
    TrainDtn(train_dtn::TrainArgs),
}

/// Read every picture of frames and hold them against their list
#[derive(clap::Args)]
struct CheckArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
}

/// Runs `scaleproof attack …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Render(args) => render::run(&args, out),
        What::Import(args) => import::run(&args, out),
        What::Check(args) => check(&args, out),
        What::Colours(args) => colours::run(&args, out),
        What::Chart(args) => chart::run(&args, out),
        What::Evaluate(args) => evaluate::run(&args, out),
        #[cfg(feature = "attack")]
        What::TrainDtn(args) => train_dtn::run(&args, out),
    }
}

fn check(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    for frame in &set.list.frames {
        set.check_pictures(frame)?;
    }
    let [width, height] = set.list.size_px;
    writeln!(out, "{} frames of {width}×{height} px are whole", set.list.frames.len())?;
    Ok(Outcome::Done)
}
