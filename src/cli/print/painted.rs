//! Results of `print wrap --paints`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

use super::pieces;
use crate::cli::print::paint::{PaintsAnswer, paint_facts};
use scaleproof_surface::model::Model;
use scaleproof_wrap::pieces::painted::PaintedPieces;

/// `print wrap --paints --json`.
#[derive(Serialize, JsonSchema)]
pub struct Answer {
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

pub fn facts(model: &Model, made: &PaintedPieces) -> Answer {
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
