//! `scaleproof print check`: the page that measures a printer.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, PaperArgs, told, written};
use scaleproof_print::check::check;

#[derive(clap::Args)]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    paper: PaperArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let media = args.paper.media()?;
    let sheets = check(&media)?;
    let output = args.paper.output()?;
    let files = output.files("Printer check", &["check".to_owned()], &sheets)?;
    output.write(&files)?;
    let next = media.printer.verify_command();
    // One page is one file.
    let words = format!("{}: print at 100 %, measure, then {next}", files[0].0.display());
    told(args.json, written(&files, Answer { next }), words, out)
}

/// `print check --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// The command to run with what was measured.
    next: String,
}
