//! `scaleproof print template`: a repeated pattern, tiled.

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use super::paint::{self, PaintArgs};
use super::{CommandResult, NewFile, PaperArgs, told, value_names, written};
use crate::cli::advice::import_command;
use crate::cli::{Result, enlarged, progress, units};
use scaleproof_core::files;
use scaleproof_core::spelling;
use scaleproof_plot::lettering;
use scaleproof_print::output::{SheetFormat, SheetOutput};
use scaleproof_print::paper::{self, Orientation};
use scaleproof_print::template::{
    Front, LayoutRequest, Template, TemplateError, TemplateRequest, template, texture_template,
};
use scaleproof_surface::pattern::{Pattern, card};

#[derive(clap::Args)]
pub(crate) struct TemplateArgs {
    /// The pattern: a PNG with one pixel per cell
    #[arg(long, value_name = "PNG", required_unless_present = "texture")]
    pattern: Option<PathBuf>,
    /// Instead of a pattern, an image without cells, PNG or JPEG: it is repeated as it is
    #[arg(long, value_name = "IMAGE", conflicts_with = "pattern")]
    texture: Option<PathBuf>,
    /// Dots per inch that a texture is printed with; an image that has fewer stays as it is
    #[arg(long, default_value_t = 300.0, requires = "texture", allow_negative_numbers = true)]
    dpi: f64,
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
    #[arg(long, value_parser = orientation(), default_value = "auto")]
    orientation: Orientation,
    /// Which edge of the template points to the model's front
    #[arg(long, value_parser = front(), default_value = "left")]
    front: Front,
    #[command(flatten)]
    paint: PaintArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

value_names!(orientation -> Orientation: Auto "auto", Portrait "portrait", Landscape "landscape");
value_names!(front -> Front: Left "left", Right "right", Up "up", Down "down", None "none");

pub(crate) fn run(args: &TemplateArgs, out: &mut dyn Write) -> CommandResult {
    let painted = args.texture.as_deref().or(args.pattern.as_deref());
    if let Some(sides) = painted.filter(|path| card::says_sides(path)) {
        let sides = sides.display();
        return Err(format!(
            "{sides} is a pattern for each side of the model (so says its card), and lies on no flat sheet: print it by `scaleproof print wrap --texture {sides}`"
        )
        .into());
    }
    match (&args.texture, &args.pattern) {
        (Some(texture), _) => run_texture(args, texture, out),
        (None, Some(pattern)) => run_pattern(args, pattern, out),
        (None, None) => Err("give --pattern or --texture".into()),
    }
}

fn print(
    (args, request): (&TemplateArgs, &TemplateRequest),
    draw: &dyn Fn() -> Result<Template, TemplateError>,
    grain: fn(f64) -> Grain,
    out: &mut dyn Write,
) -> CommandResult {
    let (made, files) = write(draw, request, &args.paper.output()?)?;
    let words = said(&files[0].0, &made, &grain(made.cell_mm));
    let outcome = told(args.json, written(&files, facts(&made, grain)), words, out)?;
    units::note(doubt(request));
    Ok(outcome)
}

fn doubt(request: &TemplateRequest) -> Option<String> {
    units::template(request.layout.size_mm, request.tile_mm, request.scale)
}

fn run_pattern(args: &TemplateArgs, path: &Path, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(path)?;
    let request = request(args, path, super::tile_mm(args.tile_mm, path, &pattern)?)?;
    let output = args.paper.output()?;
    let Some(paints) = args.paint.paints()? else {
        let draw = || template(&pattern, &request);
        return print((args, &request), &draw, Grain::CellMm, out);
    };
    let doubt = doubt(&request);
    let outcome = paint::run(&pattern, request, &paints, &output, (args.json, out))?;
    units::note(doubt);
    Ok(outcome)
}

fn run_texture(args: &TemplateArgs, path: &Path, out: &mut dyn Write) -> CommandResult {
    if args.paint.is_asked() {
        let command = import_command(path);
        let sheets = "stencils and sheets to paint by number are made of cells, and a texture has none";
        return Err(format!("{sheets}; make a pattern of it: {command}").into());
    }
    let texture = enlarged::picture(path)?;
    let missing = "a texture needs the width of one repeat: give --tile-mm";
    let request = request(args, path, args.tile_mm.ok_or(missing)?)?;
    let draw = || texture_template(&texture, args.dpi, &request);
    print((args, &request), &draw, Grain::PixelMm, out)
}

/// A PDF whose name this program chose, in a folder that a user named.
pub(crate) fn write_template(pattern: &Pattern, request: &TemplateRequest, output: &Path) -> Result<Template> {
    let made = template(pattern, request)?;
    let pdf = SheetOutput::named(output, Some(SheetFormat::Pdf))?;
    let new = pdf.files(&request.title(), &made.page_names(), &made.pages)?;
    files::replace_all_atomically(files::folder_of(output), &new)?;
    Ok(made)
}

fn write(
    draw: &dyn Fn() -> Result<Template, TemplateError>,
    request: &TemplateRequest,
    output: &SheetOutput,
) -> Result<(Template, Vec<NewFile>)> {
    progress::busy("drawing").during(|_| {
        let made = draw()?;
        let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
        output.write(&files)?;
        Ok((made, files))
    })
}

fn request(args: &TemplateArgs, path: &Path, tile_mm: f64) -> Result<TemplateRequest> {
    let layout = LayoutRequest {
        size_mm: paper::size_mm(&args.size_mm)?,
        media: args.paper.media()?,
        orientation: args.orientation,
        overlap_mm: args.overlap_mm,
        bleed_mm: args.bleed_mm,
    };
    let pattern_name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    Ok(TemplateRequest {
        tile_mm,
        scale: args.scale,
        pattern_name,
        front: args.front,
        layout,
    })
}

/// `print template --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    sheets: usize,
    /// How the sheets lie.
    rows: usize,
    columns: usize,
    /// Width and height of a page.
    page_mm: [f64; 2],
    #[serde(flatten)]
    grain: Grain,
}

/// The smallest thing on paper.
#[derive(Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Grain {
    /// Side of a cell of a pattern, mm.
    CellMm(f64),
    /// With `--texture`: width of a printed pixel, mm.
    PixelMm(f64),
}

fn facts(made: &Template, grain: fn(f64) -> Grain) -> Answer {
    let layout = &made.layout;
    let page = layout.frame.page;
    Answer {
        sheets: layout.sheets.len(),
        rows: layout.rows,
        columns: layout.columns,
        page_mm: [page.width_mm, page.height_mm],
        grain: grain(made.cell_mm),
    }
}

pub(crate) fn summary(output: &Path, made: &Template) -> String {
    said(output, made, &Grain::CellMm(made.cell_mm))
}

fn said(output: &Path, made: &Template, grain: &Grain) -> String {
    let grain = match grain {
        Grain::CellMm(mm) => format!("cells of {} mm", lettering::number(*mm)),
        Grain::PixelMm(mm) => format!("a texture of {:.0} dpi", 25.4 / mm),
    };
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
    let [width, height] = [page.width_mm, page.height_mm].map(lettering::number);
    format!(
        "{}: instructions and {count} of {width} × {height} mm, {grain}; print at 100 %",
        output.display()
    )
}
