//! `scaleproof attack chart`: surrogate renderers against each other.

use std::io::Write;
use std::path::PathBuf;

use super::render::hexes;
use crate::cli::{CommandResult, Outcome, Result, progress};
use scaleproof_core::files;
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::chart::{draw, draw_training, measure, numbers, table};
use scaleproof_frames::surrogate::dtn::file;

/// Every surrogate renderer on frames: error in flat colours it has not seen, and with patterns, against milliseconds
#[derive(clap::Args)]
pub(in crate::cli) struct ChartArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
    /// The colours models are fitted to, as hex: the first two, the first three, …
    #[arg(long, value_name = "HEX", num_args = 2..=8, default_values = ["000000", "ffffff", "808080"])]
    reference: Vec<String>,
    /// Trained networks to put beside them (attack train-dtn)
    #[arg(long, value_name = "FILE", num_args = 1..)]
    network: Vec<PathBuf>,
    /// Folder for the charts (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// Print renderers.json instead of the table
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
    files::check_writable(&args.output)?;
    let set = FrameSet::open(&args.frames)?;
    let references = hexes(&args.reference)?;
    let rows = progress::frames("measuring", set.view_count()).during(|bar| -> Result<_> {
        let networks = args.network.iter().map(|path| file::load(path));
        let networks = networks
            .map(|trainer| Ok(trainer?.network()))
            .collect::<Result<Vec<_>>>()?;
        Ok(measure(&set, &references, &networks, || bar.inc(1))?)
    })?;
    let json = numbers(&set, &args.reference, &rows)?;
    let mut new = vec![
        (args.output.join("renderers.json"), json.clone().into_bytes()),
        (args.output.join("renderers.svg"), draw(&rows).into_bytes()),
    ];
    new.extend(draw_training(&rows).map(|svg| (args.output.join("training.svg"), svg.into_bytes())));
    files::replace_all_atomically(&args.output, &new)?;
    if args.json {
        writeln!(out, "{json}")?;
        return Ok(Outcome::Done);
    }
    write!(out, "{}", table(&rows))?;
    for (path, _) in &new {
        writeln!(out, "{}", path.display())?;
    }
    Ok(Outcome::Done)
}
