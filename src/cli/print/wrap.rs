//! Results of `print wrap`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_print::wrap::Wrap;
use scaleproof_surface::model::Model;

/// `print wrap --panels --json`.
#[derive(Serialize, JsonSchema)]
pub struct PanelsAnswer {
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

pub fn facts(model: &Model, made: &Wrap) -> PanelsAnswer {
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
