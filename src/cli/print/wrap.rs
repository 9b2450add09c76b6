//! `scaleproof print wrap`: a pattern on a model, in pieces or as panels.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::pieces::{self, Named, PiecesArgs};
use super::{CommandResult, Outcome, PaperArgs, write_files, write_json};
use crate::cli::model::{Model, ModelArgs};
use crate::cli::{progress, units};
use crate::pattern::Pattern;
use crate::print::lettering;
use crate::print::wrap::{Wrap, WrapRequest, wrap};
use crate::texture::{Texture, Tile};

/// Strip that neighbouring sheets of a panel share where nothing is said.
const OVERLAP_MM: f64 = 8.0;

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
    #[command(flatten)]
    pieces: PiecesArgs,
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
    /// Strip that neighbouring sheets of a panel share for gluing, in mm [default: 8]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    overlap_mm: Option<f64>,
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
            pattern_name: file_name(name),
            date: self.paper.date()?,
            paper: self.paper.paper.parse()?,
            overlap_mm: self.overlap_mm.unwrap_or(OVERLAP_MM),
            margin_mm: self.paper.margin_mm,
            printer: self.paper.printer()?,
        })
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default()
}

pub(crate) fn run(args: &WrapArgs, out: &mut dyn Write) -> CommandResult {
    let pattern = Pattern::load(&args.pattern)?;
    let model = args.model.load()?;
    let tile_mm = super::tile_mm(args.tile_mm, &args.pattern, &pattern)?;
    let inputs = [
        Some(args.pattern.as_path()),
        args.model.mesh.as_deref(),
        args.model.scene.as_deref(),
        args.sheets.paper.printer.as_deref(),
    ];
    if args.pieces.panels {
        panels(args, (&model, &pattern, tile_mm), &inputs, out)?;
    } else {
        if args.sheets.overlap_mm.is_some() {
            return Err(
                "no piece is spread over sheets, so nothing overlaps; leave out --overlap-mm, or give --panels".into(),
            );
        }
        let facts = format!(
            "sha256 {} · tile {} mm",
            pattern.sha256().get(..12).unwrap_or_default(),
            lettering::number(tile_mm)
        );
        let texture = Texture::Tile(Tile::new(pattern, tile_mm));
        let named = Named {
            texture: &texture,
            name: file_name(&args.pattern),
            facts,
        };
        pieces::run(
            &args.pieces,
            &args.sheets.paper,
            (&model, named),
            &inputs,
            (args.json, &mut *out),
        )?;
    }
    if args.model.mesh.is_some() {
        units::note(units::turned(model.mesh.size_mm()));
    }
    Ok(Outcome::Done)
}

/// `--panels`.
fn panels(
    args: &WrapArgs,
    (model, pattern, tile_mm): (&Model, &Pattern, f64),
    inputs: &[Option<&Path>],
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let sheets = &args.sheets;
    let request = sheets.request(tile_mm, model.scale, &args.pattern)?;
    let output = sheets.paper.output()?;
    let busy = progress::busy("wrapping");
    let made = wrap(&model.mesh, &model.materials, pattern, &request)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    write_files(&files, inputs)?;
    busy.finish_and_clear();
    if made.unlettered_mm > 0.0 {
        let length_mm = made.unlettered_mm;
        say!("note: {length_mm:.0} mm of seams have no letter, as one of their panels has no room beside them");
    }
    if args.json {
        return write_json(&files, facts(model, &made), out);
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
    Ok(())
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
        "surface_mm2": made.surface_mm2,
        "unprinted_mm2": made.unprinted_mm2(),
        "largest_stretch": made.largest_stretch(),
        "mean_stretch": made.mean_stretch(),
    })
}
