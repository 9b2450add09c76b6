//! `scaleproof print template`: a repeated pattern, tiled.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use serde_json::json;

use super::paint::{self, PaintArgs};
use super::{CommandResult, NewFile, Outcome, SheetFormatName, printer, sheet_output, write_files, write_json};
use crate::cli::{progress, units};
use crate::pattern::Pattern;
use crate::print::output::{SheetFormat, SheetOutput};
use crate::print::template::{LayoutRequest, Template, TemplateRequest, template};
use crate::print::{lettering, paper};

#[derive(clap::Args)]
pub(crate) struct TemplateArgs {
    /// The pattern: a PNG with one pixel per cell
    #[arg(long, value_name = "PNG")]
    pattern: PathBuf,
    /// Printed width of one repeat of the pattern, in mm; without it, what the pattern's card says
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tile_mm: Option<f64>,
    /// Width and height of the whole template, in mm, as in 600x300
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    size_mm: String,
    /// a4, a3, letter, tabloid, WxH in mm, or a roll by its width in mm, as in roll610
    #[arg(long, default_value = "a4", allow_hyphen_values = true)]
    paper: String,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// pdf, or svg (one file a page); without it, what the file's name ends in
    #[arg(long, value_enum)]
    format: Option<SheetFormatName>,
    /// The model is 1:SCALE (named in the captions)
    #[arg(long, default_value_t = 10.0, allow_negative_numbers = true)]
    scale: f64,
    /// Strip that neighbouring sheets share for gluing, in mm
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 8.0,
        allow_negative_numbers = true,
        conflicts_with = "paint"
    )]
    overlap_mm: f64,
    /// How far the pattern runs on beyond the template's outer edge, in mm
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 2.0,
        allow_negative_numbers = true,
        conflicts_with = "paint"
    )]
    bleed_mm: f64,
    /// Border of the paper that the printer cannot reach, in mm
    #[arg(long, value_name = "MM", default_value_t = 5.0, allow_negative_numbers = true)]
    margin_mm: f64,
    /// Which way round the paper is used; auto needs the fewest sheets
    #[arg(long, value_enum, default_value_t = Orientation::Auto)]
    orientation: Orientation,
    /// Which edge of the template points to the model's front
    #[arg(long, value_enum, default_value_t = Front::Left)]
    front: Front,
    /// Take back the stretch of this printer: a file of `print verify`
    #[arg(long, value_name = "TOML")]
    printer: Option<PathBuf>,
    /// A day for the caption, as YYYY-MM-DD
    #[arg(long, value_name = "DATE")]
    date: Option<String>,
    #[command(flatten)]
    paint: PaintArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Orientation {
    Auto,
    Portrait,
    Landscape,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Front {
    Left,
    Right,
    Up,
    Down,
    None,
}

impl From<Front> for crate::print::template::Front {
    fn from(choice: Front) -> Self {
        match choice {
            Front::Left => Self::Left,
            Front::Right => Self::Right,
            Front::Up => Self::Up,
            Front::Down => Self::Down,
            Front::None => Self::None,
        }
    }
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

pub(crate) fn run(args: &TemplateArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(&args.pattern)?;
    let request = request(args, &pattern)?;
    let doubt = units::template(request.layout.size_mm, request.tile_mm, request.scale);
    let output = sheet_output(&args.output, args.format)?;
    if let Some(paints) = args.paint.paints()? {
        let inputs = [Some(&*args.pattern), args.printer.as_deref(), args.paint.palette_file()];
        paint::run(&pattern, request, &paints, &output, &inputs, (args.json, out))?;
    } else {
        let (made, files) = write(
            &pattern,
            &request,
            &output,
            &[Some(&args.pattern), args.printer.as_deref()],
        )?;
        if args.json {
            write_json(&files, facts(&made), out)?;
        } else {
            writeln!(out, "{}", summary(&files[0].0, &made))?;
        }
    }
    units::note(doubt);
    Ok(Outcome::Done)
}

/// Draws a template and writes it to a PDF.
pub(crate) fn write_template(
    pattern: &Pattern,
    request: &TemplateRequest,
    output: &Path,
) -> Result<Template, Box<dyn Error>> {
    Ok(write(
        pattern,
        request,
        &SheetOutput::named(output, Some(SheetFormat::Pdf))?,
        &[],
    )?
    .0)
}

/// Gives the files as well.
fn write(
    pattern: &Pattern,
    request: &TemplateRequest,
    output: &SheetOutput,
    inputs: &[Option<&Path>],
) -> Result<(Template, Vec<NewFile>), Box<dyn Error>> {
    let busy = progress::busy("drawing");
    let made = template(pattern, request)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    write_files(&files, inputs)?;
    busy.finish_and_clear();
    Ok((made, files))
}

fn request(args: &TemplateArgs, pattern: &Pattern) -> Result<TemplateRequest, Box<dyn Error>> {
    let layout = LayoutRequest {
        size_mm: paper::size_mm(&args.size_mm)?,
        paper: args.paper.parse()?,
        orientation: args.orientation.into(),
        overlap_mm: args.overlap_mm,
        bleed_mm: args.bleed_mm,
        margin_mm: args.margin_mm,
        printer: printer(args.printer.as_deref())?,
    };
    let pattern_name = args
        .pattern
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    Ok(TemplateRequest {
        tile_mm: super::tile_mm(args.tile_mm, &args.pattern, pattern)?,
        scale: args.scale,
        pattern_name,
        front: args.front.into(),
        date: args.date.as_deref().map(str::parse).transpose()?,
        layout,
    })
}

/// `--json`.
fn facts(made: &Template) -> serde_json::Value {
    let layout = &made.layout;
    let page = layout.frame.page;
    json!({
        "sheets": layout.sheets.len(),
        "rows": layout.rows,
        "columns": layout.columns,
        "page_mm": [page.width_mm, page.height_mm],
        "cell_mm": made.cell_mm,
    })
}

pub(crate) fn summary(output: &Path, made: &Template) -> String {
    let layout = &made.layout;
    let count = match layout.sheets.len() {
        1 => "1 sheet".to_owned(),
        n => format!("{n} sheets ({} rows of {})", layout.rows, layout.columns),
    };
    let page = layout.frame.page;
    let [width, height, cell] = [page.width_mm, page.height_mm, made.cell_mm].map(lettering::number);
    format!(
        "{}: instructions and {count} of {width} × {height} mm, cells of {cell} mm; print at 100 %",
        output.display()
    )
}
