//! `scaleproof detectors speed`: how many milliseconds does each detector take for a photo, on this machine?

use std::io::Write;
use std::path::PathBuf;

use super::Looking;
use crate::cli::{CommandResult, Outcome, Result};
use scaleproof_detect::{Speed, Speeds};

/// Time every detector whose weights are present, one thread, and keep the times in a file for `score --speed`.
///
/// Give photos of the size that will be scored. The time runs from the decoded photo to its boxes; the fastest of twenty rounds counts for
/// each photo.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    looking: Looking,
    /// What to call the machine, e.g. "laptop, Core i5-1240P"; stands beside the chart.
    #[arg(long)]
    machine: String,
    /// The file of times.
    #[arg(short, long, alias = "out", value_name = "JSON")]
    output: PathBuf,
    /// The times as one JSON object instead of the text.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(mut args: Args, out: &mut dyn Write) -> CommandResult {
    let (detectors, photos) = args.looking.open()?;
    let photos = photos.iter().map(|photo| photo.rgb(1));
    let photos = photos.collect::<Result<Vec<_>, _>>()?;
    let width = detectors
        .iter()
        .map(|(m, _)| m.name.chars().count())
        .max()
        .unwrap_or(0)
        .max(14);
    let tell = |speed: &Speed| -> Result<()> {
        let (name, median, [fastest, slowest]) = (&speed.detector, speed.ms_per_photo, speed.ms_range);
        if !args.json {
            writeln!(
                out,
                "{name:<width$} {median:>8.2} ms a photo ({fastest:.2} to {slowest:.2})"
            )?;
        }
        Ok(())
    };
    let speeds = Speeds::measure(args.machine, &detectors, &photos, tell)?;
    speeds.write(&args.output)?;
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&speeds)?)?;
    }
    Ok(Outcome::Done)
}
