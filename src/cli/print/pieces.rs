//! Results of `print wrap`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_surface::model::Model;
use scaleproof_wrap::pieces::{Piece, Place, PrintedPieces, reason};
use scaleproof_wrap::unwrap::LeftOut;

/// `print wrap --json`. Lengths over others are mm on the surface for 1 mm on paper, or the inverse.
#[derive(Serialize, JsonSchema)]
pub struct PiecesAnswer {
    /// Length, width, height.
    model_size_mm: [f64; 3],
    pieces: Vec<PieceAnswer>,
    /// Sheets that carry pieces.
    sheets: usize,
    /// Width and height of a page.
    page_mm: [f64; 2],
    seams: usize,
    /// Length of the seams without a letter on one of their pieces.
    unlettered_mm: f64,
    /// Length of all that is cut.
    cut_mm: f64,
    /// Of all pieces.
    surface_mm2: f64,
    /// Paint that can be seen from outside.
    visible_mm2: f64,
    left_out: Vec<LeftOutPaint>,
    /// Mean by area.
    mean_stretch: f64,
    /// 99th percentile.
    stretch_99: f64,
    largest_stretch: f64,
}

/// A piece of the model's surface.
#[derive(Serialize, JsonSchema)]
pub struct PieceAnswer {
    /// Its number, from 1.
    piece: usize,
    /// The sheet it is on, from 1.
    sheet: usize,
    /// Area of the surface.
    surface_mm2: f64,
    /// Area on paper.
    flat_mm2: f64,
}

/// Paint on no piece.
#[derive(Serialize, JsonSchema)]
pub struct LeftOutPaint {
    surface_mm2: f64,
    triangles: usize,
    reason: &'static str,
}

pub fn facts(model: &Model, made: &PrintedPieces) -> PiecesAnswer {
    PiecesAnswer {
        model_size_mm: model.mesh.size_mm(),
        pieces: each(&made.pieces, &made.places).collect(),
        sheets: made.sheets(),
        page_mm: [made.frame.page.width_mm, made.frame.page.height_mm],
        seams: made.seams.len(),
        unlettered_mm: made.unlettered_mm,
        cut_mm: made.cut_mm(),
        surface_mm2: made.flat.surface_mm2(),
        visible_mm2: made.flat.visible_mm2,
        left_out: left_out(&made.flat.left_out),
        mean_stretch: made.flat.mean_stretch,
        stretch_99: made.flat.stretch_99,
        largest_stretch: made.flat.largest_stretch,
    }
}

pub fn each(pieces: &[Piece], places: &[Place]) -> impl Iterator<Item = PieceAnswer> {
    let placed = pieces.iter().zip(places).enumerate();
    placed.map(|(i, (piece, place))| PieceAnswer {
        piece: i + 1,
        sheet: place.page + 1,
        surface_mm2: piece.surface_mm2,
        flat_mm2: piece.region.area_mm2(),
    })
}

/// Paint that is on no piece, and why.
pub fn left_out(parts: &[LeftOut]) -> Vec<LeftOutPaint> {
    let part = |part: &LeftOut| LeftOutPaint {
        surface_mm2: part.surface_mm2,
        triangles: part.triangles.len(),
        reason: reason(part.reason),
    };
    parts.iter().map(part).collect()
}
