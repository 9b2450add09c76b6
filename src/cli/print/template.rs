//! `scaleproof print template`: a repeated pattern, tiled.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::paint::{self, PaintArgs};
use super::{CommandResult, NewFile, Outcome, PaperArgs, value_names, write_files, write_json};
use crate::cli::{progress, units};
use crate::pattern::Pattern;
use crate::print::lettering;
use crate::print::output::{SheetFormat, SheetOutput};
use crate::print::paper::{self, Orientation};
use crate::print::template::{Front, LayoutRequest, Template, TemplateRequest, template};
use crate::spelling;

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
    #[command(flatten)]
    paper: PaperArgs,
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
    /// Which way round the paper is used; auto needs the fewest sheets
    #[arg(long, value_enum, default_value_t = Orientation::Auto)]
    orientation: Orientation,
    /// Which edge of the template points to the model's front
    #[arg(long, value_enum, default_value_t = Front::Left)]
    front: Front,
    #[command(flatten)]
    paint: PaintArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

value_names!(Orientation: Auto "auto", Portrait "portrait", Landscape "landscape");
value_names!(Front: Left "left", Right "right", Up "up", Down "down", None "none");

pub(crate) fn run(args: &TemplateArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(&args.pattern)?;
    let request = request(args, &pattern)?;
    let doubt = units::template(request.layout.size_mm, request.tile_mm, request.scale);
    let output = args.paper.output()?;
    if let Some(paints) = args.paint.paints()? {
        let inputs = [
            Some(&*args.pattern),
            args.paper.printer.as_deref(),
            args.paint.palette.as_deref(),
        ];
        paint::run(&pattern, request, &paints, &output, &inputs, (args.json, out))?;
    } else {
        let (made, files) = write(
            &pattern,
            &request,
            &output,
            &[Some(&args.pattern), args.paper.printer.as_deref()],
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
        paper: args.paper.paper.parse()?,
        orientation: args.orientation,
        overlap_mm: args.overlap_mm,
        bleed_mm: args.bleed_mm,
        margin_mm: args.paper.margin_mm,
        printer: args.paper.printer()?,
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
        front: args.front,
        date: args.paper.date()?,
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
        n => format!(
            "{n} sheets ({} of {})",
            spelling::count(layout.rows, "row"),
            layout.columns
        ),
    };
    let page = layout.frame.page;
    let [width, height, cell] = [page.width_mm, page.height_mm, made.cell_mm].map(lettering::number);
    format!(
        "{}: instructions and {count} of {width} × {height} mm, cells of {cell} mm; print at 100 %",
        output.display()
    )
}
