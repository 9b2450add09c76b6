//! What only a program with the feature `full` has. Without it, `light.rs` stands here.

mod advise;
mod attack;
mod board;
mod calibrate;
mod chart;
mod fetch;
pub(super) mod interrupt;
mod mesh_step;
mod painted;
mod patch;
mod pieces;
mod survey;
mod texture;
mod textures;
mod wrap;

use std::io::Write;

use clap::Subcommand;

use super::CommandResult;
use super::advice::Advise;
use crate::cli::answer::{Named, Written, named};

pub(super) use fetch::download;
pub(super) use interrupt::{end_programs_first, let_an_interruption_end_first};
pub(super) use mesh_step::SceneMesh;

#[derive(Subcommand)]
pub(super) enum Command {
    Advise(advise::Args),
    /// From frames of a painted model to a pattern that detectors do not see it in
    #[command(subcommand)]
    Attack(attack::Command),
    Calibrate(calibrate::Args),
    /// Textures as images for simulators, and as previews
    #[command(subcommand)]
    Texture(textures::Command),
    Capture(crate::cli::args::capture::Args),
    Survey(survey::Args),
    /// Chart methods against each other, on the same photos
    #[command(subcommand)]
    Chart(chart::Command),
}

/// The advice of each of these commands that has some.
pub(super) const ADVICE: &[Advise] = &[attack::advice, fetch::advice, survey::advice, wrap::advice];

pub(super) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Advise(args) => advise::run(&args, out),
        Command::Attack(command) => attack::run(command, out),
        Command::Calibrate(args) => calibrate::run(args, out),
        Command::Texture(command) => textures::run(&command, out),
        Command::Capture(args) => crate::cli::commands::capture::run(args, out),
        Command::Survey(args) => survey::run(args, out),
        Command::Chart(command) => chart::run(command, out),
    }
}

/// More of `scaleproof print …`: what lies on a model.
#[derive(Subcommand)]
pub(super) enum OnModelCommand {
    /// Wrap a texture around a model: pieces to cut out and glue, or five panels
    Wrap(wrap::WrapArgs),
    /// Print finished patches: their places on the panels of a model, and each to cut out
    Patch(patch::PatchArgs),
}

pub(super) fn print_on_model(command: OnModelCommand, out: &mut dyn Write) -> CommandResult {
    match command {
        OnModelCommand::Wrap(args) => wrap::run(&args, out),
        OnModelCommand::Patch(args) => patch::run(&args, out),
    }
}

/// More of `scaleproof print …`.
#[derive(Subcommand)]
pub(super) enum PrintCommand {
    /// Print a calibration board, and write the file that describes it
    Board(board::BoardArgs),
}

pub(super) fn print(command: PrintCommand, out: &mut dyn Write) -> CommandResult {
    let PrintCommand::Board(args) = command;
    board::run(&args, out)
}

/// More of `scaleproof session …`.
#[derive(Subcommand)]
pub(super) enum SessionCommand {
    FromVideo(crate::cli::args::film::FilmArgs),
}

pub(super) fn session(command: SessionCommand, out: &mut dyn Write) -> CommandResult {
    let SessionCommand::FromVideo(args) = command;
    crate::cli::commands::film::run(&args, out)
}

/// More of `scaleproof detectors …`.
#[derive(Subcommand)]
pub(super) enum DetectorsCommand {
    Fetch(fetch::FetchArgs),
}

pub(super) fn detectors(command: DetectorsCommand, out: &mut dyn Write) -> CommandResult {
    let DetectorsCommand::Fetch(args) = command;
    fetch::run(args, out)
}

pub(super) fn schemas() -> Vec<Named> {
    let mut all = vec![
        named::<scaleproof_study::advise::Advice>("advice"),
        named::<scaleproof_rig::calibrate::CalibrationAnswer>("calibrate"),
        named::<crate::cli::print::capture::Line>("capture"),
        named::<crate::cli::print::capture::Cameras>("capture-list-cameras"),
        named::<fetch::Fetched>("detectors-fetch"),
        named::<Written<board::Answer>>("print-board"),
        named::<Written<patch::Answer>>("print-patch"),
        named::<Written<pieces::PiecesAnswer>>("print-wrap"),
        named::<Written<painted::Answer>>("print-wrap-paints"),
        named::<Written<wrap::PanelsAnswer>>("print-wrap-panels"),
        named::<survey::SurveyJson>("survey"),
        named::<crate::cli::print::film::Answer>("session-from-video"),
        named::<Written<textures::Baked>>("texture-bake"),
        named::<Written<textures::Shown>>("texture-show"),
    ];
    all.extend(attack::schemas());
    all.extend(chart::schemas());
    all
}
