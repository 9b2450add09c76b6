//! `scaleproof print`: sheets for the printer.

mod board;
mod check;
mod tags;
mod template;
mod verify;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;

use super::{CommandResult, Outcome};
use crate::files;
use crate::print::printer::Printer;
use crate::print::sheet::Sheet;
use crate::print::{pdf, svg};

use template::same_file;
pub use template::{summary, write_template};

/// Print sheets in true millimetres
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Spread a repeated pattern over sheets of paper, to be cut and glued
    Template(template::TemplateArgs),
    /// Print the tags of a scene: tent cards to cut and fold, a ground mat, plain cards
    Tags(tags::TagsArgs),
    /// Print a calibration board, and write the file that describes it
    Board(board::BoardArgs),
    /// One page that shows whether the printer keeps lengths
    Check(check::CheckArgs),
    /// Write down what the rulers measured, as printer.toml
    Verify(verify::VerifyArgs),
}

/// Runs `scaleproof print …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Template(args) => template::run(&args, out),
        What::Tags(args) => tags::run(&args, out),
        What::Board(args) => board::run(&args, out),
        What::Check(args) => check::run(&args, out),
        What::Verify(args) => verify::run(&args, out),
    }
}

/// What the sheets are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// One file with all pages
    Pdf,
    /// One file a page, named OUTPUT-PAGE.svg
    Svg,
}

impl Format {
    /// The one asked for, or the one the file's name asks for.
    fn of(asked: Option<Self>, output: &Path) -> Self {
        let is_svg = output.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
        asked.unwrap_or(if is_svg { Self::Svg } else { Self::Pdf })
    }
}

/// Writes all pages, or none. Gives the files written, the one to look at first in front.
fn write_pages(
    format: Format,
    output: &Path,
    title: &str,
    pages: (&[String], &[Sheet]),
) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let (names, sheets) = pages;
    let written = match format {
        Format::Pdf => vec![(output.to_owned(), pdf::write(title, sheets)?)],
        Format::Svg => {
            let named = names.iter().zip(sheets);
            let file = |(name, sheet): (&String, &Sheet)| {
                let text = svg::write(&format!("{title}: {name}"), sheet);
                (svg_path(output, name), text.into_bytes())
            };
            named.map(file).collect()
        }
    };
    files::write_all_atomically(&written)?;
    Ok(written.into_iter().map(|(path, _)| path).collect())
}

/// `out/t.svg` and sheet `B2` give `out/t-B2.svg`.
fn svg_path(output: &Path, name: &str) -> PathBuf {
    let stem = output.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    output.with_file_name(format!("{}-{name}.svg", stem.unwrap_or_default()))
}

fn printer(file: Option<&Path>) -> Result<Printer, Box<dyn Error>> {
    Ok(file.map(Printer::load).transpose()?.unwrap_or(Printer::EXACT))
}
