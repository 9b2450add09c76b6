//! `scaleproof print verify`: from two measured lengths to a printer file.

use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::{CommandResult, told, written};
use scaleproof_core::files;
use scaleproof_print::printer::{Printer, PrinterFile};

#[derive(clap::Args)]
pub(crate) struct VerifyArgs {
    /// What the 100 mm along the paper's short side (across a roll) measure, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    x_mm: f64,
    /// What the 100 mm along the paper's long side measure, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    y_mm: f64,
    /// The correction that the measured page was printed with, if any
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// The file to write
    #[arg(short, long, value_name = "TOML", default_value = "printer.toml")]
    output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: &VerifyArgs, out: &mut dyn Write) -> CommandResult {
    // A page printed with a correction measures true; without naming it here, the correction would be taken for none.
    files::inputs::own(&args.output);
    let there = args.output.exists().then(|| PrinterFile::load(&args.output));
    let only_colours = matches!(&there, Some(Ok(file)) if file.printer == Printer::EXACT);
    if args.printer.is_none() && there.is_some() && !only_colours {
        let output = args.output.display();
        return Err(format!(
            "{output} is there already: add --printer {output} if the measured page was printed with it, else remove it or give another -o"
        )
        .into());
    }
    let measured = Printer::measured(args.x_mm, args.y_mm)?;
    let known = match args.printer.as_deref() {
        Some(file) => Some(PrinterFile::load(file)?),
        // A file of `colour read` has corrected no page, and its colours are kept.
        None => there.transpose()?,
    };
    let printer = known
        .as_ref()
        .map_or(Printer::EXACT, |file| file.printer)
        .remeasured(&measured)?;
    let file = PrinterFile {
        printer,
        colours: known.and_then(|file| file.colours),
    };
    let new = [(args.output.clone(), file.to_toml()?.into_bytes())];
    files::write_all_atomically(&new)?;
    let (output, correction) = (args.output.display(), printer.caption());
    let words = format!("{output}: {correction}; print with --printer {output}");
    told(args.json, written(&new, Answer { correction }), words, out)
}

/// `print verify --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    /// The correction in words.
    correction: String,
}
