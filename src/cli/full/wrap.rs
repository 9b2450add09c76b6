//! `scaleproof print wrap`: a pattern on a model, in pieces or as panels.

use std::error::Error;
use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::painted;
use super::pieces::{self, PiecesArgs};
use crate::cli::CommandResult;
use crate::cli::answer::{told, written};
use crate::cli::args::model::ModelArgs;
use crate::cli::full::texture::{NamedTexture, TextureArgs};
use crate::cli::print::PaperArgs;
use crate::cli::print::paint::PaintArgs;
use crate::cli::resolve::model::simplify;
use crate::cli::{Result, advice, progress};
use scaleproof_plot::lettering;
use scaleproof_print::wrap::{Wrap, WrapRequest, wrap};
use scaleproof_surface::model::Model;
use scaleproof_wrap::pieces::painted::PaintedError;
use scaleproof_wrap::pieces::{PiecesError, UnwrapError};

/// Strip that neighbouring sheets of a panel share where nothing is said.
const OVERLAP_MM: f64 = 8.0;
/// Pixels per inch where nothing is said.
pub(super) const DPI: f64 = 300.0;

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
    #[command(flatten)]
    paint: PaintArgs,
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
    pub(crate) fn request(&self, scale: f64) -> Result<WrapRequest> {
        Ok(WrapRequest {
            scale,
            name: String::new(),
            facts: String::new(),
            dpi: DPI,
            overlap_mm: self.overlap_mm.unwrap_or(OVERLAP_MM),
            media: self.paper.media()?,
        })
    }
}

pub(crate) fn run(args: &WrapArgs, out: &mut dyn Write) -> CommandResult {
    let mut model = args.model.load_or(args.texture.mesh())?;
    if !args.pieces.panels && !args.texture.is_of_triangles(&model) {
        simplify(&mut model, args.texture.texture.is_some());
    }
    let painted = args.texture.load(&model)?;
    let request = || -> Result<WrapRequest> {
        Ok(WrapRequest {
            name: painted.name.clone(),
            facts: pieces::captioned(&painted),
            dpi: args.pieces.dpi,
            ..args.sheets.request(model.scale)?
        })
    };
    if args.pieces.panels {
        panels(args, (&model, &painted), request()?, out)
    } else if args.sheets.overlap_mm.is_some() {
        Err("no piece is spread over sheets, so nothing overlaps; leave out --overlap-mm, or give --panels".into())
    } else if let Some(paints) = args.paint.paints()? {
        let request = args.pieces.request(request()?);
        let output = args.sheets.paper.output()?;
        painted::run((&model, &painted.texture, &paints), request, &output, (args.json, out))
    } else {
        let output = args.sheets.paper.output()?;
        let request = args.pieces.request(request()?);
        pieces::run((&model, &painted), &request, &output, (args.json, out))
    }
}

/// `--panels`.
fn panels(
    args: &WrapArgs,
    (model, painted): (&Model, &NamedTexture),
    request: WrapRequest,
    out: &mut dyn Write,
) -> CommandResult {
    let output = args.sheets.paper.output()?;
    let busy = progress::busy("wrapping");
    let made = wrap(&model.mesh, &model.materials, &painted.texture, &request)?;
    let files = output.files(&request.title(), &made.page_names(), &made.pages)?;
    output.write(&files)?;
    busy.finish_and_clear();
    if made.unlettered_mm > 0.0 {
        let length_mm = made.unlettered_mm;
        say!("note: {length_mm:.0} mm of seams have no letter, as one of their panels has no room beside them");
    }
    let cells = made
        .cell_mm
        .map(|mm| format!(", cells of {} mm", lettering::number(mm)));
    let head = format!(
        "{}: instructions and {} panels of {}{}; print at 100 %",
        files[0].0.display(),
        made.pieces.len(),
        model.in_words(),
        cells.unwrap_or_default()
    );
    let words = [vec![head], made.facts()].concat().join("\n");
    told(args.json, written(&files, facts(model, &made)), words, out)
}

/// `print wrap --panels --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct PanelsAnswer {
    /// Length, width, height.
    model_size_mm: [f64; 3],
    /// Side of a cell of a pattern.
    cell_mm: Option<f64>,
    panels: Vec<PanelAnswer>,
    /// Of all paint.
    surface_mm2: f64,
    /// Paint that looks down and is on no panel.
    unprinted_mm2: f64,
    /// Of all panels.
    largest_stretch: f64,
    /// Mean stretch of all panels, surface over paper.
    mean_stretch: f64,
}

#[derive(Serialize, JsonSchema)]
struct PanelAnswer {
    /// Side of the model.
    panel: &'static str,
    sheets: usize,
    /// Area on paper.
    flat_mm2: f64,
    /// Area of the surface.
    surface_mm2: f64,
    /// Surface over paper.
    largest_stretch: f64,
}

fn facts(model: &Model, made: &Wrap) -> PanelsAnswer {
    let panels = made.pieces.iter().map(|piece| PanelAnswer {
        panel: piece.panel.side.name(),
        sheets: piece.layout.sheets.len(),
        flat_mm2: piece.panel.flat_mm2(),
        surface_mm2: piece.panel.surface_mm2,
        largest_stretch: piece.panel.largest_stretch,
    });
    PanelsAnswer {
        model_size_mm: model.mesh.size_mm(),
        cell_mm: made.cell_mm,
        panels: panels.collect(),
        surface_mm2: made.surface_mm2,
        unprinted_mm2: made.unprinted_mm2(),
        largest_stretch: made.largest_stretch(),
        mean_stretch: made.mean_stretch(),
    }
}

pub(super) fn advice(error: &(dyn Error + 'static)) -> Option<String> {
    advice_by_kind! { error,
        PaintedError::Pieces(e) => advice(e)?,
        PaintedError::Paint(e) => advice::on(e)?,
        PiecesError::Unwrap(UnwrapError::TooFewPieces { .. }) =>
            " (--pieces, --max-stretch, --mean-stretch, --paper; --material, --faces or the scene's paint leave out what is not painted)",
        PiecesError::Unwrap(UnwrapError::BadStretch { .. }) => " (--max-stretch, --mean-stretch)",
        PiecesError::Raster(_) => " (--dpi)",
    }
}
