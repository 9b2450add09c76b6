//! `scaleproof print`: sheets for the printer.

#[cfg(feature = "full")]
pub mod attack;
#[cfg(feature = "full")]
pub mod board;
#[cfg(feature = "full")]
pub mod capture;
mod chart;
mod check;
#[cfg(feature = "full")]
pub mod fetch;
#[cfg(feature = "full")]
pub mod film;
pub(super) mod paint;
#[cfg(feature = "full")]
pub mod painted;
#[cfg(feature = "full")]
pub mod patch;
#[cfg(feature = "full")]
pub mod pieces;
#[cfg(feature = "full")]
pub mod survey;
mod tags;
pub(crate) mod template;
#[cfg(feature = "full")]
pub mod textures;
mod verify;
#[cfg(feature = "full")]
pub mod wrap;

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;

use super::answer::{Named, Written, named, told, written};
use super::enlarged::note_enlarged;
use super::{CommandResult, Result, full};
use scaleproof_print::media::Media;
use scaleproof_print::output::{OutputError, SheetFormat, SheetOutput};
use scaleproof_print::paper::Stock;
use scaleproof_print::printer::Printer;
use scaleproof_print::sheet::Sheet;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::{self, CardError};

pub(crate) use template::{summary, write_template};

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Spread a repeated pattern over sheets of paper, to be cut and glued
    Template(template::TemplateArgs),
    #[command(flatten)]
    OnModel(full::OnModelCommand),
    /// Print the tags of a scene: tent cards to cut and fold, a ground mat, plain cards
    Tags(tags::TagsArgs),
    #[command(flatten)]
    Full(full::PrintCommand),
    /// A chart of colours, fewer on smaller paper, to be photographed for `colour read`
    Chart(chart::ChartArgs),
    /// One page that shows whether the printer keeps lengths
    Check(check::CheckArgs),
    /// Write down what the rulers measured, as printer.toml
    Verify(verify::VerifyArgs),
}

/// Runs `scaleproof print …`.
pub(crate) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    match command {
        Command::Template(args) => template::run(&args, out),
        Command::OnModel(command) => full::print_on_model(command, out),
        Command::Tags(args) => tags::run(&args, out),
        Command::Full(command) => full::print(command, out),
        Command::Chart(args) => chart::run(&args, out),
        Command::Check(args) => check::run(&args, out),
        Command::Verify(args) => verify::run(&args, out),
    }
}

/// A parser of an option whose values are choices of the library: each with its name, and what the help says of it.
macro_rules! value_names {
    ($parser:ident -> $choice:ident: $($variant:ident $name:literal $($help:literal)?),+) => {
        fn $parser() -> impl clap::builder::TypedValueParser<Value = $choice> {
            use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
            let names = [$(PossibleValue::new($name)$(.help($help))?),+];
            PossibleValuesParser::new(names).try_map(|name| match name.as_str() {
                $($name => Ok($choice::$variant),)+
                other => Err(format!("{other} is no choice")),
            })
        }
    };
}
pub(super) use value_names;

value_names!(sheet_format -> SheetFormat: Pdf "pdf" "One file with all pages", Svg "svg" "One file a page, named OUTPUT-PAGE.svg");

/// A file to be written: where, and its bytes.
pub(super) type NewFile = (PathBuf, Vec<u8>);

/// What is printed on cut paper, not tiled, and where it is written.
#[derive(clap::Args)]
pub(super) struct CutSheetArgs {
    /// a0 to a5, letter, legal, tabloid, ledger, or WxH in mm, or in inches as in 13x19in; tags also on a roll by its width in mm, as in roll610
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// Correct the sizes by this file of `print verify`
    #[arg(long, value_name = "TOML")]
    pub(super) printer: Option<PathBuf>,
    /// The file to write
    #[arg(short, long, alias = "out", value_name = "FILE")]
    pub(super) output: PathBuf,
    /// pdf, or svg (one file a page); without it, what the file's name ends in
    #[arg(long, value_parser = sheet_format())]
    format: Option<SheetFormat>,
}

impl CutSheetArgs {
    pub(super) fn media(&self) -> Result<Media> {
        Ok(Media {
            printer: printer(self.printer.as_deref())?,
            ..Media::new(self.paper.parse::<Stock>()?)
        })
    }

    pub(super) fn file(&self, title: &str, sheet: &Sheet) -> Result<Vec<NewFile>> {
        Ok(self
            .output()?
            .files(title, &["1".to_owned()], std::slice::from_ref(sheet))?)
    }

    fn output(&self) -> Result<SheetOutput, OutputError> {
        SheetOutput::named(&self.output, self.format)
    }
}

/// The width of a repeat: as given, else as the pattern's card says.
pub(in crate::cli) fn tile_mm(given: Option<f64>, path: &Path, pattern: &Pattern) -> Result<f64, String> {
    let found = card::tile_mm(given, path, pattern);
    if found.is_ok() {
        note_enlarged(path, pattern);
    }
    found.map_err(|error| card_fault(&error))
}

/// Returns the sentence on a faulty or missing card of a pattern, and what to do.
pub(in crate::cli) fn card_fault(error: &CardError) -> String {
    match error {
        CardError::None { .. } => format!("{error}: give --tile-mm"),
        CardError::Content { .. } | CardError::OtherPattern { .. } => {
            format!("{error}: give --tile-mm, or remove the file")
        }
        CardError::OfSides { .. } => format!("{error}: give it with --texture"),
        CardError::File(_) => error.to_string(),
    }
}

/// What tiled sheets and the check page are printed on, and where they are written.
#[derive(clap::Args)]
pub(crate) struct PaperArgs {
    /// a0 to a5, letter, legal, tabloid, ledger, WxH in mm, or in inches as in 13x19in, or a roll by its width in mm, as in roll610
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
    /// pdf, or svg (one file a page); without it, what the file's name ends in
    #[arg(long, value_parser = sheet_format())]
    pub(super) format: Option<SheetFormat>,
    /// Border of the paper that the printer cannot reach, in mm
    #[arg(long, value_name = "MM", default_value_t = 5.0, allow_negative_numbers = true)]
    margin_mm: f64,
    /// Correct the sizes by this file of `print verify`
    #[arg(long, value_name = "TOML")]
    pub(super) printer: Option<PathBuf>,
    /// A day for the caption, as YYYY-MM-DD
    #[arg(long, value_name = "DATE")]
    date: Option<String>,
}

impl PaperArgs {
    pub(super) fn output(&self) -> Result<SheetOutput, OutputError> {
        SheetOutput::named(&self.output, self.format)
    }

    pub(super) fn media(&self) -> Result<Media> {
        Ok(Media {
            paper: self.paper.parse()?,
            margin_mm: self.margin_mm,
            printer: printer(self.printer.as_deref())?,
            date: self.date.as_deref().map(str::parse).transpose()?,
        })
    }
}

fn printer(file: Option<&Path>) -> Result<Printer> {
    Ok(file.map(Printer::load).transpose()?.unwrap_or(Printer::EXACT))
}

pub(super) fn schemas() -> Vec<Named> {
    vec![
        named::<Written<chart::Answer>>("print-chart"),
        named::<Written<check::Answer>>("print-check"),
        named::<Written<tags::Answer>>("print-tags"),
        named::<Written<template::Answer>>("print-template"),
        named::<Written<paint::Answer>>("print-template-paints"),
        named::<Written<verify::Answer>>("print-verify"),
    ]
}
