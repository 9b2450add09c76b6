//! `scaleproof attack chart`: surrogate renderers against each other.

use std::io::Write;

use crate::cli::args::attack::chart::ChartArgs;
use crate::cli::resolve::attack::render::hexes;
use crate::cli::{CommandResult, Outcome, Result, progress};
use scaleproof_core::files;
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::chart::{draw, draw_training, measure, numbers, table};
use scaleproof_frames::surrogate::dtn::file;

pub fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
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
