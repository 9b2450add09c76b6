//! Commands of programs with the feature `full`. Without it, `light.rs` stands here.

use std::io::Write;

use clap::Subcommand;

use super::CommandResult;
use super::advice::Advise;
use crate::cli::answer::{Named, Written, named};
use crate::cli::args::{advise, attack, board, calibrate, capture, chart, fetch, film, patch, survey, textures, wrap};
use crate::cli::{commands, print};

pub(super) use crate::cli::args::mesh_step::SceneMesh;
pub(super) use commands::fetch::download;
pub(super) use commands::interrupt::{end_programs_first, let_an_interruption_end_first};

#[derive(Subcommand)]
pub(super) enum Command {
    Advise(advise::Args),
    /// From frames of a painted model to a pattern that detectors do not see it in
    #[command(subcommand)]
    Attack(attack::command::Command),
    Calibrate(calibrate::Args),
    /// Textures as images for simulators, and as previews
    #[command(subcommand)]
    Texture(textures::Command),
    Capture(capture::Args),
    Survey(survey::Args),
    /// Chart methods against each other, on the same photos
    #[command(subcommand)]
    Chart(chart::Command),
}

/// The advice of each of these commands that has some.
pub(super) const ADVICE: &[Advise] = &[
    commands::fetch::advice,
    commands::survey::advice,
    commands::wrap::advice,
];

pub(super) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Advise(args) => commands::advise::run(&args, out),
        Command::Attack(command) => commands::attack::command::run(command, out),
        Command::Calibrate(args) => commands::calibrate::run(args, out),
        Command::Texture(command) => commands::textures::run(&command, out),
        Command::Capture(args) => commands::capture::run(args, out),
        Command::Survey(args) => commands::survey::run(args, out),
        Command::Chart(command) => commands::chart::run(command, out),
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
        OnModelCommand::Wrap(args) => commands::wrap::run(&args, out),
        OnModelCommand::Patch(args) => commands::patch::run(&args, out),
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
    commands::board::run(&args, out)
}

/// More of `scaleproof session …`.
#[derive(Subcommand)]
pub(super) enum SessionCommand {
    FromVideo(film::FilmArgs),
}

pub(super) fn session(command: SessionCommand, out: &mut dyn Write) -> CommandResult {
    let SessionCommand::FromVideo(args) = command;
    commands::film::run(&args, out)
}

/// More of `scaleproof detectors …`.
#[derive(Subcommand)]
pub(super) enum DetectorsCommand {
    Fetch(fetch::FetchArgs),
}

pub(super) fn detectors(command: DetectorsCommand, out: &mut dyn Write) -> CommandResult {
    let DetectorsCommand::Fetch(args) = command;
    commands::fetch::run(args, out)
}

pub(super) fn schemas() -> Vec<Named> {
    let mut all = vec![
        named::<scaleproof_study::advise::Advice>("advice"),
        named::<scaleproof_rig::calibrate::CalibrationAnswer>("calibrate"),
        named::<print::capture::Line>("capture"),
        named::<print::capture::Cameras>("capture-list-cameras"),
        named::<print::fetch::Fetched>("detectors-fetch"),
        named::<Written<print::board::Answer>>("print-board"),
        named::<Written<print::patch::Answer>>("print-patch"),
        named::<Written<print::pieces::PiecesAnswer>>("print-wrap"),
        named::<Written<print::painted::Answer>>("print-wrap-paints"),
        named::<Written<print::wrap::PanelsAnswer>>("print-wrap-panels"),
        named::<print::survey::SurveyJson>("survey"),
        named::<print::film::Answer>("session-from-video"),
        named::<Written<print::textures::Baked>>("texture-bake"),
        named::<Written<print::textures::Shown>>("texture-show"),
    ];
    all.extend(commands::attack::command::schemas());
    all.extend(commands::chart::schemas());
    all
}
