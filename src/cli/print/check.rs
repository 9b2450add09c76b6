//! `scaleproof print check`: the page that measures a printer.

use std::io::Write;
use std::path::PathBuf;

use serde_json::json;

use super::{CommandResult, Outcome, SheetFormatName, printer, sheet_output, write_files, write_json};
use crate::print::check::{CheckRequest, check};

#[derive(clap::Args)]
pub(crate) struct CheckArgs {
    /// a4, a3, letter, tabloid, WxH in mm, or a roll by its width in mm, as in roll610
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// pdf, or svg; without it, what the file's name ends in
    #[arg(long, value_enum)]
    format: Option<SheetFormatName>,
    /// Border of the paper that the printer cannot reach, in mm
    #[arg(long, value_name = "MM", default_value_t = 5.0, allow_negative_numbers = true)]
    margin_mm: f64,
    /// Try out the correction in this file of `print verify`
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// A day for the caption, as YYYY-MM-DD
    #[arg(long, value_name = "DATE")]
    date: Option<String>,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &CheckArgs, out: &mut dyn Write) -> CommandResult {
    let request = CheckRequest {
        paper: args.paper.parse()?,
        margin_mm: args.margin_mm,
        printer: printer(args.printer.as_deref())?,
        date: args.date.as_deref().map(str::parse).transpose()?,
    };
    let sheets = check(&request)?;
    let files = sheet_output(&args.output, args.format)?.files("Printer check", &["check".to_owned()], &sheets)?;
    write_files(&files, &[args.printer.as_deref()])?;
    if args.json {
        write_json(&files, json!({ "next": request.printer.verify_command() }), out)?;
        return Ok(Outcome::Done);
    }
    for (path, _) in files {
        writeln!(
            out,
            "{}: print at 100 %, measure, then {}",
            path.display(),
            request.printer.verify_command()
        )?;
    }
    Ok(Outcome::Done)
}
