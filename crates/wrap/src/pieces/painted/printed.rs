//! Stencils of a model in pieces, and what is said of them.

use super::material::Material;
use super::regions::PaintedPiece;
use crate::pieces::flat::Piece;
use crate::pieces::nest::Place;
use crate::pieces::{cm2, left_out_facts, pages};
use crate::unwrap::Unwrapped;
use scaleproof_core::spelling::count;
use scaleproof_plot::lettering::number;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::paint::PaintArea;
use scaleproof_print::paint::plane::Area;
use scaleproof_print::printer;
use scaleproof_print::sheet::Sheet;
use scaleproof_surface::pattern::palette::Painted;

/// Cuts for a paint in a piece's material, turned upright.
#[derive(Debug, Clone)]
pub struct PieceStencil {
    pub piece: usize,
    /// Index of the paint, from 0 in the order of spraying.
    pub paint: usize,
    pub openings: Area,
    pub bridges: Area,
}

#[derive(Debug, Clone)]
pub struct PaintedPieces {
    pub pieces: Vec<Piece>,
    pub places: Vec<Place>,
    pub frame: PageFrame,
    /// Paints in the order of spraying: the largest first.
    pub painted: Painted,
    /// Areas of each paint, on paper. The first has no stencil.
    pub areas: Vec<PaintArea>,
    pub regions: Vec<PaintedPiece>,
    pub materials: Vec<Material>,
    /// Stencils with an opening, paint by paint.
    pub stencils: Vec<PieceStencil>,
    /// Number and area, mm², of parts of a paint's area that are too narrow to be cut.
    pub narrow: (usize, f64),
    pub flat: Unwrapped,
    pub min_feature_mm: f64,
    /// Instructions, the legend, the sheets to paint by number, then the stencils paint by paint; corrected for the printer.
    pub pages: Vec<Sheet>,
    /// Name of each page, used if it becomes a file of its own.
    pub names: Vec<String>,
}

impl PaintedPieces {
    pub fn sheets(&self) -> usize {
        pages::sheets(&self.places)
    }

    /// Returns the facts, one per sentence.
    pub fn facts(&self) -> Vec<String> {
        let mut facts = vec![
            format!(
                "{} on {}, {}: {} of paint, {:.1} % of what can be seen",
                count(self.pieces.len(), "piece"),
                count(self.sheets(), "sheet"),
                count(self.stencils.len(), "stencil"),
                cm2(self.flat.surface_mm2()),
                100.0 * self.flat.surface_mm2() / self.flat.visible_mm2.max(f64::MIN_POSITIVE)
            ),
            format!(
                "stretch (mm on the surface for 1 mm on paper, or the inverse): mean {:.3}, 99th percentile {:.3}",
                self.flat.mean_stretch, self.flat.stretch_99
            ),
        ];
        let (parts, mm2) = self.narrow;
        if parts > 0 {
            facts.push(format!(
                "{} narrower than {} mm, {}, not cut: touch up by number",
                count(parts, "part"),
                number(self.min_feature_mm),
                cm2(mm2)
            ));
        }
        facts.extend(left_out_facts(&self.flat.left_out));
        facts
    }

    pub(crate) fn add(&mut self, name: String, sheet: Sheet) {
        let stretch = self.frame.setup.stretch();
        self.pages.push(printer::corrected_one(sheet, stretch));
        self.names.push(name);
    }
}
