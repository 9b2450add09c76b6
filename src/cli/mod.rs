//! One file per subcommand: arguments in, library call, text out.

#[macro_use]
mod advice;
mod answer;
#[cfg(feature = "full")]
mod args;
mod at_hand;
mod camera;
mod choice;
mod colour;
#[cfg(feature = "full")]
mod commands;
mod compare;
mod completions;
mod criteria;
mod defence;
mod demo;
mod detectors;
mod enlarged;
#[cfg(feature = "full")]
mod full;
#[cfg(not(feature = "full"))]
#[path = "light.rs"]
mod full;
pub mod in_process;
mod locate;
mod merge;
mod mistakes;
mod output;
mod overview;
mod own_file;
mod pattern;
mod patterns;
mod photos;
mod plan;
mod print;
#[cfg(feature = "full")]
mod resolve;
mod results;
mod scene;
mod schemas;
mod score;
mod session;
mod sessions;
#[cfg_attr(not(feature = "full"), allow(dead_code))]
mod taken;
mod units;

use std::error::Error;
use std::ffi::OsString;
use std::io::Write;

use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use scaleproof_terminal::{Visible, progress};

/// Print an adversarial pattern at 1:10, photograph the model, and get numbers you can defend.
#[derive(Parser)]
#[command(version, about)]
struct Cli {
    /// No progress and no notes; results and errors stay
    #[arg(short, long, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Args),
    /// Print sheets in true millimetres
    #[command(subcommand)]
    Print(print::Command),
    /// Make scene files
    #[command(subcommand)]
    Scene(scene::Command),
    /// Make and check patterns
    #[command(subcommand)]
    Pattern(pattern::Command),
    /// Convert, show and guess camera files
    #[command(subcommand)]
    Camera(camera::Command),
    /// Measure a printer's colours
    #[command(subcommand)]
    Colour(colour::Command),
    Locate(locate::Args),
    /// List, fetch, try out and add object detectors.
    #[command(subcommand)]
    Detectors(detectors::Command),
    /// Make a session of photos that are there already, show what is in one, or export it for other programs.
    #[command(subcommand)]
    Session(session::Command),
    Score(score::Args),
    Merge(merge::Args),
    Compare(compare::Args),
    Plan(plan::Args),
    #[command(flatten)]
    Full(full::Command),
    Completions(completions::Args),
    #[command(hide = true)]
    Manuals(completions::ManualsArgs),
    #[command(hide = true)]
    Schemas(schemas::Args),
}

/// Advice on errors that only a program with these features meets.
const MORE_ADVICE: &[advice::Advise] = full::ADVICE;

/// Outcome of a finished command, which decides the exit code.
enum Outcome {
    Done,
    /// The answers that could be given were given, but some input was bad: exit code 2.
    SomeInputBad,
}

type Result<T, E = Box<dyn Error>> = std::result::Result<T, E>;

type CommandResult = Result<Outcome>;

/// Runs the program with its arguments, the program's own name first. Exit code 0 when all went well, 2 for bad input, with one sentence on
/// standard error.
pub(crate) fn main(arguments: &[OsString]) -> u8 {
    keep_to_ourselves();
    scaleproof_core::workers::memory::keep();
    scaleproof_core::files::inputs::guard();
    scaleproof_core::files::limit::fail_instead_of_ending();
    // Results name files in JSON, which is UTF-8.
    if let Some(argument) = arguments.iter().skip(1).find(|argument| argument.to_str().is_none()) {
        return refuse(&format!("{} is not UTF-8 text: give another name", argument.display()));
    }
    let mut command = command();
    let parsed = command.try_get_matches_from_mut(arguments);
    let parsed = parsed.and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(e) if is_mistake(&e) => return refuse(&mistakes::sentence(&e, &command, arguments)),
        Err(help_or_version) => help_or_version.exit(),
    };
    if cli.quiet {
        scaleproof_terminal::be_quiet();
    }
    // A file that goes to standard output is alone there.
    let out: &mut dyn Write = match output::goes_to_standard_output(&command, &matches) {
        Err(sentence) => return refuse(&sentence),
        Ok(true) => &mut Visible(std::io::stderr().lock()),
        Ok(false) => &mut Visible(std::io::stdout().lock()),
    };
    match done(cli.command, out) {
        Ok(Outcome::Done) => 0,
        Ok(Outcome::SomeInputBad) => 2,
        Err(e) if is_broken_pipe(e.as_ref()) => 0,
        Err(e) => {
            full::let_an_interruption_end_first();
            advice::say(e.as_ref());
            2
        }
    }
}

/// Runs a command; all that it prints is out when it returns.
fn done(command: Command, out: &mut dyn Write) -> CommandResult {
    let outcome = match command {
        Command::Demo(args) => demo::run(args, out),
        Command::Print(command) => print::run(command, out),
        Command::Scene(command) => scene::run(command, out),
        Command::Pattern(command) => pattern::run(command, out),
        Command::Camera(command) => camera::run(command, out),
        Command::Colour(command) => colour::run(command, out),
        Command::Locate(args) => locate::run(args, out),
        Command::Detectors(command) => detectors::run(command, out),
        Command::Session(command) => session::run(command, out),
        Command::Score(args) => score::run(args, out),
        Command::Merge(args) => merge::run(args, out),
        Command::Compare(args) => compare::run(args, out),
        Command::Plan(args) => plan::run(args, out),
        Command::Full(command) => full::run(command, out),
        Command::Completions(args) => completions::run(&args, out),
        Command::Manuals(args) => completions::run_manuals(&args, out),
        Command::Schemas(args) => schemas::run(&args, out),
    }?;
    out.flush()?;
    Ok(outcome)
}

fn command() -> clap::Command {
    overview::explained(Cli::command())
}

fn refuse(sentence: &str) -> u8 {
    say!("error: {sentence}");
    2
}

/// ONNX Runtime's own builds would report to Microsoft what they run on: its API switches off what is sent, this also what is kept for it
/// in the user's cache, before the library is loaded.
fn keep_to_ourselves() {
    // SAFETY: no other thread has been started yet that could read the environment.
    unsafe { std::env::set_var("ORT_DISABLE_TELEMETRY", "1") };
}

/// False for help and version, also when help is shown because nothing was asked.
fn is_mistake(e: &clap::Error) -> bool {
    e.use_stderr() && e.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
}

/// `scaleproof locate … | head` closes our output early; that is no error.
fn is_broken_pipe(e: &(dyn Error + 'static)) -> bool {
    e.downcast_ref::<std::io::Error>()
        .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}
