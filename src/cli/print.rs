//! `scaleproof print`: sheets for the printer.

mod board;
mod tags;

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::{Subcommand, ValueEnum};

use super::{CommandResult, Outcome};
use crate::files;
use crate::pattern::Pattern;
use crate::print::template::{LayoutRequest, Template, TemplateRequest, template};
use crate::print::{lettering, paper, pdf};

/// Print sheets in true millimetres
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Spread a repeated pattern over sheets of paper, to be cut and glued
    Template(TemplateArgs),
    /// Print the tags of a scene: tent cards to cut and fold, a ground mat, plain cards
    Tags(tags::TagsArgs),
    /// Print a calibration board, and write the file that describes it
    Board(board::BoardArgs),
}

#[derive(clap::Args)]
struct TemplateArgs {
    /// The pattern: a PNG with one pixel per cell
    #[arg(long, value_name = "PNG")]
    pattern: PathBuf,
    /// Printed width of one repeat of the pattern, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tile_mm: f64,
    /// Width and height of the whole template, in mm, as in 600x300
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    size_mm: String,
    /// a4, a3, letter, tabloid, or WxH in mm
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// The PDF to write
    #[arg(short, long, value_name = "PDF")]
    output: PathBuf,
    /// The model is 1:SCALE (named in the captions)
    #[arg(long, default_value_t = 10.0, allow_negative_numbers = true)]
    scale: f64,
    /// Strip that neighbouring sheets share for gluing, in mm
    #[arg(long, value_name = "MM", default_value_t = 8.0, allow_negative_numbers = true)]
    overlap_mm: f64,
    /// Border of the paper that the printer cannot reach, in mm
    #[arg(long, value_name = "MM", default_value_t = 5.0, allow_negative_numbers = true)]
    margin_mm: f64,
    /// Which way round the paper is used; auto needs the fewest sheets
    #[arg(long, value_enum, default_value_t = Orientation::Auto)]
    orientation: Orientation,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Orientation {
    Auto,
    Portrait,
    Landscape,
}

impl From<Orientation> for paper::Orientation {
    fn from(choice: Orientation) -> Self {
        match choice {
            Orientation::Auto => Self::Auto,
            Orientation::Portrait => Self::Portrait,
            Orientation::Landscape => Self::Landscape,
        }
    }
}

/// Runs `scaleproof print …`.
pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Template(args) => run_template(&args, out),
        What::Tags(args) => tags::run(&args, out),
        What::Board(args) => board::run(&args, out),
    }
}

fn run_template(args: &TemplateArgs, out: &mut dyn Write) -> CommandResult {
    if same_file(&args.pattern, &args.output) {
        return Err("the PDF would overwrite the pattern; give another output file".into());
    }
    let pattern = Pattern::load(&args.pattern)?;
    let made = write_template(&pattern, &request(args)?, &args.output)?;
    writeln!(out, "{}", summary(&args.output, &made))?;
    Ok(Outcome::Done)
}

/// Draws a template and writes it to a PDF.
pub fn write_template(pattern: &Pattern, request: &TemplateRequest, output: &Path) -> Result<Template, Box<dyn Error>> {
    let made = template(pattern, request)?;
    let title = format!(
        "Template of {}, tile {} mm",
        request.pattern_name,
        lettering::number(request.tile_mm)
    );
    files::write_atomically(output, &pdf::write(&title, &made.sheets)?)?;
    Ok(made)
}

fn request(args: &TemplateArgs) -> Result<TemplateRequest, Box<dyn Error>> {
    let layout = LayoutRequest {
        size_mm: paper::size_mm(&args.size_mm)?,
        paper: args.paper.parse()?,
        orientation: args.orientation.into(),
        overlap_mm: args.overlap_mm,
        margin_mm: args.margin_mm,
    };
    let pattern_name = args
        .pattern
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    Ok(TemplateRequest {
        tile_mm: args.tile_mm,
        scale: args.scale,
        pattern_name,
        layout,
    })
}

pub fn summary(output: &Path, made: &Template) -> String {
    let Template {
        layout,
        cell_mm,
        sheets,
    } = made;
    let count = match sheets.len() {
        1 => "1 sheet".to_owned(),
        n => format!("{n} sheets ({} rows of {})", layout.rows, layout.columns),
    };
    let [width, height, cell] = [layout.page.width_mm, layout.page.height_mm, *cell_mm].map(lettering::number);
    format!(
        "{}: {count} of {width} × {height} mm, cells of {cell} mm; print at 100 %",
        output.display()
    )
}

/// Whether two paths name one existing file.
fn same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}
