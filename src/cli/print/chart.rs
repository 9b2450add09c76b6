//! `scaleproof print chart`: the colours to photograph.

use std::io::Write;

use super::{CutSheetArgs, write_files};
use crate::cli::{CommandResult, Outcome};
use crate::print::chart::chart;

#[derive(clap::Args)]
pub struct ChartArgs {
    #[command(flatten)]
    sheets: CutSheetArgs,
}

/// Runs `scaleproof print chart`.
pub fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
    let made = chart(args.sheets.media()?)?;
    let title = format!("Colour chart {}", made.layout.kind.name());
    let files = args.sheets.files(&title, std::slice::from_ref(&made.sheet))?;
    write_files(&files, &[args.sheets.printer.as_deref()])?;
    let (path, levels, patches) = (
        files[0].0.display(),
        made.layout.kind.levels().len(),
        made.layout.patches.len(),
    );
    writeln!(
        out,
        "{path}: {patches} patches, {levels} levels a channel and greys; print at 100 %, photograph, then scaleproof colour read \
         PHOTO -o printer.toml"
    )?;
    Ok(Outcome::Done)
}
