//! The paint mode of `scaleproof print wrap`: stencils of every piece, and pieces to paint by number.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::pieces;
use crate::cli::CommandResult;
use crate::cli::answer::{told, written};
use crate::cli::print::paint::{Paints, PaintsAnswer, paint_facts, table};
use crate::cli::progress;
use scaleproof_core::spelling::count;
use scaleproof_print::output::SheetOutput;
use scaleproof_surface::model::Model;
use scaleproof_surface::texture::Texture;
use scaleproof_wrap::pieces::PiecesRequest;
use scaleproof_wrap::pieces::painted::{PaintedPieces, PaintedRequest, flattened, painted_pieces};

pub(super) fn run(
    (model, texture, paints): (&Model, &Texture, &Paints),
    request: PiecesRequest,
    output: &SheetOutput,
    (as_json, out): (bool, &mut dyn Write),
) -> CommandResult {
    let Texture::Tile(tile) = texture else {
        return Err(
            "stencils and sheets to paint by number are made of cells, and a texture has none; give --pattern instead of --texture, as \
             scaleproof pattern import IMAGE --cells 24 makes one"
                .into(),
        );
    };
    let painted = paints.painted(&tile.pattern)?;
    let request = PaintedRequest {
        pieces: request,
        min_feature_mm: paints.min_feature_mm,
        mirror: paints.mirror,
    };
    let busy = progress::steps("unwrapping and cutting stencils", 100);
    let surface = (&model.mesh, &*model.materials);
    let flat = flattened(surface, tile, &request, &mut |share| {
        busy.set_position((60.0 * share) as u64)
    })?;
    let made = painted_pieces(&model.mesh, &flat, (tile, &painted), &request)?;
    let files = output.files(&request.title(), &made.names, &made.pages)?;
    output.write(&files)?;
    busy.set_position(100);
    busy.finish_and_clear();
    let paints = count(made.painted.paints.len(), "paint");
    let words = [
        vec![format!(
            "{}: {paints} on {}; print at 100 %",
            files[0].0.display(),
            model.in_words()
        )],
        made.facts(),
        vec![table(&made.painted, &made.areas, "all pieces")],
        vec!["paint 1 is the base coat: it is sprayed on everything first, without a stencil".to_owned()],
    ];
    let words = words.concat().join("\n");
    told(as_json, written(&files, facts(model, &made)), words, out)
}

/// `print wrap --paints --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Answer {
    #[serde(flatten)]
    paints: PaintsAnswer,
    /// Length, width, height.
    model_size_mm: [f64; 3],
    pieces: Vec<StencilledPiece>,
    /// Sheets that carry pieces, for each paint.
    sheets: usize,
    /// Parts that are too narrow to be cut.
    narrow_parts: usize,
    narrow_mm2: f64,
    /// Of all pieces.
    surface_mm2: f64,
    /// Paint that can be seen from outside.
    visible_mm2: f64,
    left_out: Vec<pieces::LeftOutPaint>,
    /// mm on the surface for 1 mm on paper, or the inverse: mean by area, and 99th percentile.
    mean_stretch: f64,
    stretch_99: f64,
}

/// A piece of the model's surface, and its stencils.
#[derive(Serialize, JsonSchema)]
struct StencilledPiece {
    #[serde(flatten)]
    piece: pieces::PieceAnswer,
    /// The paints that it has a stencil of, from 1.
    stencils: Vec<usize>,
}

fn facts(model: &Model, made: &PaintedPieces) -> Answer {
    let pieces = pieces::each(&made.pieces, &made.places).enumerate().map(|(i, piece)| {
        let stencils = made.stencils.iter().filter(|stencil| stencil.piece == i);
        let stencils = stencils.map(|stencil| stencil.paint + 1).collect();
        StencilledPiece { piece, stencils }
    });
    Answer {
        paints: paint_facts(&made.painted, &made.areas),
        model_size_mm: model.mesh.size_mm(),
        pieces: pieces.collect(),
        sheets: made.sheets(),
        narrow_parts: made.narrow.0,
        narrow_mm2: made.narrow.1,
        surface_mm2: made.flat.surface_mm2(),
        visible_mm2: made.flat.visible_mm2,
        left_out: pieces::left_out(&made.flat.left_out),
        mean_stretch: made.flat.mean_stretch,
        stretch_99: made.flat.stretch_99,
    }
}
