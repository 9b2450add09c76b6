//! `scaleproof print chart`: the colours to photograph.

use std::io::Write;
use std::path::PathBuf;

use super::{Format, as_files, cut_paper, numbered, printer, write_files};
use crate::cli::{CommandResult, Outcome};
use crate::print::chart::chart;
use crate::print::page::Media;

#[derive(clap::Args)]
pub struct ChartArgs {
    /// a4, a3, letter, tabloid, or WxH in mm; smaller paper has fewer colours
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// Correct the sizes by this file of `print verify`
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// pdf, or svg; without it, what the file's name ends in, else pdf
    #[arg(long, value_enum)]
    format: Option<Format>,
}

/// Runs `scaleproof print chart`.
pub fn run(args: &ChartArgs, out: &mut dyn Write) -> CommandResult {
    let made = chart(Media {
        paper: cut_paper(&args.paper)?,
        printer: printer(args.printer.as_deref())?,
    })?;
    let title = format!("Colour chart {}", made.layout.kind.name());
    let format = Format::of(args.format, &args.output);
    let files = as_files(
        format,
        &args.output,
        &title,
        (&numbered(1), std::slice::from_ref(&made.sheet)),
    )?;
    write_files(&files, &[args.printer.as_deref()])?;
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
