//! `scaleproof attack history`: several methods on one chart.

use std::io::Write;
use std::path::PathBuf;

use super::{CommandResult, Outcome};
use crate::attack::run::history::{History, draw};
use crate::files;

/// AP@0.5 on the held-out views against wall time, of several results of `attack run` and `attack baseline`
#[derive(clap::Args)]
pub(super) struct HistoryArgs {
    /// Folders of results
    #[arg(value_name = "DIR", required = true)]
    results: Vec<PathBuf>,
    /// Folder for the chart (SVG) and its numbers (JSON)
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The histories as one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &HistoryArgs, out: &mut dyn Write) -> CommandResult {
    let histories = args
        .results
        .iter()
        .map(|folder| History::load(folder))
        .collect::<Result<Vec<_>, _>>()?;
    if let Some(other) = histories
        .iter()
        .position(|history| !history.is_comparable(&histories[0]))
    {
        return Err(format!(
            "{} and {} were made with other frames or detectors, so their figures cannot stand on one chart",
            args.results[0].display(),
            args.results[other].display()
        )
        .into());
    }
    files::check_writable(&args.output)?;
    if !args.json {
        table(&histories, out)?;
    }
    let new = [
        (
            args.output.join("attack.json"),
            serde_json::to_string_pretty(&histories)?.into_bytes(),
        ),
        (args.output.join("attack.svg"), draw(&histories).into_bytes()),
    ];
    files::replace_all_atomically(&new)?;
    if args.json {
        let [numbers, chart] = new.map(|(path, _)| path);
        let line = serde_json::json!({ "histories": histories, "numbers": numbers, "chart": chart });
        writeln!(out, "{line}")?;
        return Ok(Outcome::Done);
    }
    for (path, _) in &new {
        writeln!(out, "{}", path.display())?;
    }
    Ok(Outcome::Done)
}

fn table(histories: &[History], out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<10} {:>5} {:>8} {:>9} {:>8} {:>7} {:>9} {:>11}",
        "method", "seed", "tile mm", "images", "seconds", "AP@0.5", "hit rate", "confidence"
    )?;
    for history in histories {
        if let Some((entry, judged)) = history.last_judged() {
            writeln!(
                out,
                "{:<10} {:>5} {:>8} {:>9} {:>8.0} {:>7.2} {:>9.2} {:>11.2}",
                history.method,
                history.seed,
                history.tile_mm,
                entry.queries,
                entry.wall_s,
                judged.ap50,
                judged.hit_rate,
                judged.mean_confidence
            )?;
        }
    }
    Ok(())
}
