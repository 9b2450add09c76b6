//! `scaleproof pattern`: make patterns.

use std::io::Write;
use std::path::PathBuf;

use clap::Subcommand;

use super::{CommandResult, Outcome};
use crate::files;
use crate::pattern::Pattern;

/// Make patterns
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// A square of uniformly random colours: the baseline every optimised pattern must beat
    Random(RandomArgs),
}

#[derive(clap::Args)]
struct RandomArgs {
    /// Cells along each side
    #[arg(long, default_value_t = 16)]
    cells: u32,
    /// The same seed gives the same pattern everywhere
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The PNG to write, one pixel per cell
    #[arg(short, long, value_name = "PNG")]
    output: PathBuf,
}

/// Runs `scaleproof pattern …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Random(args) => run_random(&args, out),
    }
}

fn run_random(args: &RandomArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::random(args.cells, args.seed)?;
    files::write_atomically(&args.output, &pattern.to_png()?)?;
    let (path, cells) = (args.output.display(), args.cells);
    writeln!(out, "{path}: {cells} × {cells} random cells, seed {}", args.seed)?;
    Ok(Outcome::Done)
}
