//! `scaleproof attack`: frames, the models that predict them, and patterns against detectors.

use super::{baseline, chart, colours, demo, evaluate, history, import, judge, photos, render, run, train_dtn};
use std::io::Write;

use crate::cli::CommandResult;
use crate::cli::answer::{Named, named, told};
use crate::cli::args::attack::command::{CheckArgs, Command};
use crate::cli::print::attack::frames::{CheckedFrames, WrittenFrames};
use scaleproof_frames::FrameSet;

/// Runs `scaleproof attack …`.
pub fn run(command: Command, out: &mut dyn Write) -> CommandResult {
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

pub fn check(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let set = FrameSet::open(&args.frames)?;
    set.list.frames.iter().try_for_each(|frame| set.check_images(frame))?;
    let (size_px, frames) = (set.list.size_px, set.list.frames.len());
    let [width, height] = size_px;
    let words = format!("{frames} frames of {width}×{height} px are whole");
    told(args.json, CheckedFrames { frames, size_px }, words, out)
}

pub fn schemas() -> Vec<Named> {
    vec![
        named::<CheckedFrames>("attack-check"),
        named::<crate::cli::print::attack::evaluate::Evaluated>("attack-evaluate"),
        named::<WrittenFrames>("attack-frames"),
        named::<crate::cli::print::attack::history::Histories>("attack-history"),
        named::<crate::cli::print::attack::judge::Judgement>("attack-judge"),
        named::<crate::cli::print::attack::photos::FramesOfPhotos>("attack-photos"),
        named::<crate::cli::print::attack::on_frames::Made>("attack-run"),
        named::<crate::cli::print::attack::train_dtn::TrainedNetwork>("attack-train-dtn"),
        named::<scaleproof_frames::surrogate::chart::Numbers>("renderers"),
    ]
}
