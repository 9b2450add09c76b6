//! `scaleproof print wrap`: a pattern on a model, in pieces or as panels.

use std::error::Error;
use std::io::Write;
use std::path::Path;

use serde_json::json;

use super::pieces::{self, PiecesArgs};
use super::{CommandResult, Outcome, PaperArgs, write_files, write_json};
use crate::cli::model::{Model, ModelArgs};
use crate::cli::texture::{NamedTexture, TextureArgs};
use crate::cli::{progress, units};
use crate::print::lettering;
use crate::print::wrap::{Wrap, WrapRequest, wrap};
use crate::texture::Texture;

/// Strip that neighbouring sheets of a panel share where nothing is said.
const OVERLAP_MM: f64 = 8.0;

#[derive(clap::Args)]
pub(crate) struct WrapArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    texture: TextureArgs,
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
            pattern_name: name
                .file_name()
                .map(|n| n.to_string_lossy().into_owned())
                .unwrap_or_default(),
            date: self.paper.date()?,
            paper: self.paper.paper.parse()?,
            overlap_mm: self.overlap_mm.unwrap_or(OVERLAP_MM),
            margin_mm: self.paper.margin_mm,
            printer: self.paper.printer()?,
        })
    }
}

pub(crate) fn run(args: &WrapArgs, out: &mut dyn Write) -> CommandResult {
    let model = args.model.load_or(args.texture.mesh())?;
    let painted = args.texture.load(&model)?;
    let mut inputs = vec![
        args.texture.file(),
        args.model.mesh.as_deref(),
        args.model.scene.as_deref(),
        args.sheets.paper.printer.as_deref(),
    ];
    inputs.extend(painted.images.iter().map(|path| Some(path.as_path())));
    if args.pieces.panels {
        panels(args, (&model, &painted), &inputs, out)?;
    } else if args.sheets.overlap_mm.is_some() {
        return Err(
            "no piece is spread over sheets, so nothing overlaps; leave out --overlap-mm, or give --panels".into(),
        );
    } else {
        pieces::run(
            &args.pieces,
            &args.sheets.paper,
            (&model, &painted),
            &inputs,
            (args.json, &mut *out),
        )?;
    }
    if model.file.is_some() {
        units::note(units::turned(model.mesh.size_mm()));
    }
    Ok(Outcome::Done)
}

/// `--panels`.
fn panels(
    args: &WrapArgs,
    (model, painted): (&Model, &NamedTexture),
    inputs: &[Option<&Path>],
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let sheets = &args.sheets;
    let Texture::Tile(tile) = &painted.texture else {
        return Err("panels of textures are being written".into());
    };
    let tile_mm = tile.cell_mm * f64::from(tile.pattern.columns());
    let request = sheets.request(tile_mm, model.scale, Path::new(&painted.name))?;
    let output = sheets.paper.output()?;
    let busy = progress::busy("wrapping");
    let made = wrap(&model.mesh, &model.materials, &tile.pattern, &request)?;
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
