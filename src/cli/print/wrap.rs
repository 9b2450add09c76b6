//! `scaleproof print wrap`: a pattern as the panels of a model.

use std::error::Error;
use std::io::Write;
use std::path::PathBuf;

use serde_json::json;

use super::{CommandResult, Outcome, PaperArgs, write_files, write_json};
use crate::cli::model::{Model, ModelArgs};
use crate::cli::{progress, units};
use crate::pattern::Pattern;
use crate::print::lettering;
use crate::print::wrap::{Kept, Wrap, WrapError, WrapRequest, wrap};

#[derive(clap::Args)]
pub(crate) struct WrapArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// The pattern: a PNG with one pixel per cell
    #[arg(long, value_name = "PNG")]
    pattern: PathBuf,
    /// Printed width of one repeat of the pattern, in mm; without it, what the pattern's card says
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tile_mm: Option<f64>,
    /// Unroll what the panels would stretch by more than --max-stretch: as strips on pages of their own
    #[arg(long)]
    flatten: bool,
    /// The mm on the surface that 1 mm on a panel's paper may stand for
    #[arg(
        long,
        value_name = "RATIO",
        requires = "flatten",
        default_value_t = 1.2,
        allow_negative_numbers = true
    )]
    max_stretch: f64,
    #[command(flatten)]
    sheets: SheetArgs,
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// What it is printed on.
#[derive(clap::Args)]
pub(crate) struct SheetArgs {
    #[command(flatten)]
    pub(super) paper: PaperArgs,
    /// Strip that neighbouring sheets share for gluing, in mm
    #[arg(long, value_name = "MM", default_value_t = 8.0, allow_negative_numbers = true)]
    overlap_mm: f64,
}

impl SheetArgs {
    pub(crate) fn request(
        &self,
        tile_mm: f64,
        scale: f64,
        name: &std::path::Path,
    ) -> Result<WrapRequest, Box<dyn Error>> {
        Ok(WrapRequest {
            tile_mm,
            scale,
            pattern_name: name
                .file_name()
                .map(|n| n.to_string_lossy().into_owned())
                .unwrap_or_default(),
            date: self.paper.date()?,
            paper: self.paper.paper.parse()?,
            overlap_mm: self.overlap_mm,
            margin_mm: self.paper.margin_mm,
            printer: self.paper.printer()?,
            max_stretch: None,
        })
    }
}

pub(crate) fn run(args: &WrapArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(&args.pattern)?;
    let model = args.model.load()?;
    let sheets = &args.sheets;
    let request = WrapRequest {
        max_stretch: args.flatten.then_some(args.max_stretch),
        ..sheets.request(
            super::tile_mm(args.tile_mm, &args.pattern, &pattern)?,
            model.scale,
            &args.pattern,
        )?
    };
    let output = sheets.paper.output()?;
    let busy = progress::busy("wrapping");
    let made = wrap(&model.mesh, &model.materials, &pattern, &request).map_err(advised)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    let inputs = [
        Some(args.pattern.as_path()),
        args.model.mesh.as_deref(),
        args.model.scene.as_deref(),
        sheets.paper.printer.as_deref(),
    ];
    write_files(&files, &inputs)?;
    busy.finish_and_clear();
    if args.model.mesh.is_some() {
        units::note(units::turned(model.mesh.size_mm()));
    }
    say_notes(args, &made);
    if args.json {
        write_json(&files, facts(&model, &made), out)?;
        return Ok(Outcome::Done);
    }
    let [length, width, height] = model.mesh.size_mm();
    writeln!(
        out,
        "{}: instructions and {} panels of a model of {length:.0} × {width:.0} × {height:.0} mm, cells of {} mm; print at 100 %",
        files[0].0.display(),
        made.pieces.len(),
        lettering::number(made.cell_mm)
    )?;
    for fact in made.facts() {
        writeln!(out, "{fact}")?;
    }
    Ok(Outcome::Done)
}

/// The error with the options that mend it.
fn advised(error: WrapError) -> String {
    let advice = match &error {
        WrapError::TooManySteep { count, most } => {
            return format!(
                "{count} triangles are steeper than --max-stretch, and no more than {most} can be unrolled; simplify the mesh, or give a \
                 larger --max-stretch"
            );
        }
        WrapError::TooManyStripCells { .. } => ", or a larger --max-stretch",
        _ => "",
    };
    format!("{error}{advice}")
}

fn say_notes(args: &WrapArgs, made: &Wrap) {
    if args.flatten && made.strips.is_empty() && made.kept == Kept::default() {
        let limit = lettering::number(args.max_stretch);
        say!("note: no surface is stretched by more than {limit}, so nothing was unrolled");
    }
    if made.unlettered_mm > 0.0 {
        let length_mm = made.unlettered_mm;
        say!("note: {length_mm:.0} mm of seams have no letter, as one of their panels has no room beside them");
    }
}

/// `--json`.
fn facts(model: &Model, made: &Wrap) -> serde_json::Value {
    let panels = made.pieces.iter().map(|piece| {
        json!({
            "panel": piece.panel.side.name(),
            "sheets": piece.layout.sheets.len(),
            "flat_mm2": piece.panel.flat_mm2(),
            "surface_mm2": piece.panel.surface_mm2,
            "largest_stretch": piece.panel.largest_stretch,
        })
    });
    json!({
        "model_size_mm": model.mesh.size_mm(),
        "cell_mm": made.cell_mm,
        "panels": panels.collect::<Vec<_>>(),
        "strips": made.strips.len(),
        "surface_mm2": made.surface_mm2,
        "unprinted_mm2": made.unprinted_mm2(),
        "largest_stretch": made.largest_stretch(),
        "mean_stretch": made.mean_stretch(),
    })
}
