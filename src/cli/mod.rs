//! One file per subcommand: arguments in, library call, text out.

mod detectors;
mod locate;
mod progress;

use std::error::Error;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Print an adversarial pattern at 1:10, photograph the model, and get numbers you can defend.
#[derive(Parser)]
#[command(version, about)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Locate(locate::Args),
    Detectors(detectors::Args),
}

/// What a finished command says to the shell.
enum Outcome {
    Done,
    /// The answers that could be given were given, but some input was bad: exit code 2.
    SomeInputBad,
}

type CommandResult = Result<Outcome, Box<dyn Error>>;

/// Runs the program. Exit code 0 when all went well, 2 for bad input, with one sentence on standard error.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let out = &mut std::io::stdout().lock();
    let result = match cli.command {
        Command::Locate(args) => locate::run(args, out),
        Command::Detectors(args) => detectors::run(args, out),
    };
    match result.and_then(|outcome| out.flush().map(|()| outcome).map_err(Into::into)) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::SomeInputBad) => ExitCode::from(2),
        Err(e) if is_broken_pipe(e.as_ref()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(2)
        }
    }
}

/// `scaleproof locate … | head` closes our output early; that is no error.
fn is_broken_pipe(e: &(dyn Error + 'static)) -> bool {
    e.downcast_ref::<std::io::Error>()
        .is_some_and(|e| e.kind() == ErrorKind::BrokenPipe)
}
