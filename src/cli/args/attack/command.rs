//! Commands of `attack`.

use super::{baseline, chart, colours, demo, evaluate, history, import, judge, photos, render, run, train_dtn};
use std::path::PathBuf;

use clap::Subcommand;

#[derive(Subcommand)]
pub enum Command {
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
pub struct CheckArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// Print a JSON object instead of the sentence
    #[arg(long)]
    pub json: bool,
}
