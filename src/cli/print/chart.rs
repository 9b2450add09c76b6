//! `scaleproof print chart`: the colours to photograph.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, CutSheetArgs, told, written};
use scaleproof_print::chart::chart;

#[derive(clap::Args)]
pub(crate) struct ChartArgs {
    #[command(flatten)]
    sheets: CutSheetArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs `scaleproof print chart`.
pub(crate) fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
    let made = chart(args.sheets.media()?)?;
    let title = format!("Colour chart {}", made.layout.kind.name());
    let files = args.sheets.file(&title, &made.sheet)?;
    args.sheets.output()?.write(&files)?;
    let (path, chart) = (files[0].0.display(), made.layout.kind.name());
    let (levels, patches) = (made.layout.kind.levels().len(), made.layout.patches.len());
    let words = format_args!(
        "{path}: {patches} patches, {levels} levels a channel and greys; print at 100 %, photograph, then scaleproof colour read \
         PHOTO -o printer.toml"
    );
    told(
        args.json,
        written(&files, Answer { chart, patches, levels }),
        words,
        out,
    )
}

/// `print chart --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// The layout.
    chart: &'static str,
    patches: usize,
    /// Levels of a channel.
    levels: usize,
}
