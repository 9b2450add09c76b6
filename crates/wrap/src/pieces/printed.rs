//! Printed pieces of a model, and what is said of them.

use super::flat::Piece;
use super::nest::Place;
use super::pages;
use super::seams::Seam;
use crate::unwrap::{LeftOut, LeftOutReason, Unwrapped};
use scaleproof_core::spelling::count;
use scaleproof_print::frame::PageFrame;
use scaleproof_print::sheet::Sheet;
use scaleproof_print::wrap::Region;

#[derive(Debug, Clone)]
pub struct PrintedPieces {
    pub pieces: Vec<Piece>,
    pub seams: Vec<Seam>,
    pub places: Vec<Place>,
    /// Area to cut out of each piece with its tabs, in its plane.
    pub cut: Vec<Region>,
    pub frame: PageFrame,
    pub flat: Unwrapped,
    /// Length of the seams without a letter on one of their sides.
    pub unlettered_mm: f64,
    /// The first page, then the sheets, corrected for the printer.
    pub pages: Vec<Sheet>,
}

impl PrintedPieces {
    /// Returns a name for each page, used if it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let sheets = (1..self.pages.len()).map(|sheet| format!("sheet-{sheet}"));
        ["assembly".to_owned()].into_iter().chain(sheets).collect()
    }

    pub fn sheets(&self) -> usize {
        pages::sheets(&self.places)
    }

    /// Returns the length of all cuts.
    pub fn cut_mm(&self) -> f64 {
        self.cut.iter().map(Region::border_mm).sum()
    }

    pub fn visible_share(&self) -> f64 {
        self.flat.surface_mm2() / self.flat.visible_mm2.max(f64::MIN_POSITIVE)
    }

    pub fn facts(&self) -> Vec<String> {
        let mut facts = vec![
            format!(
                "{} on {}: {} of paint, {:.1} % of what can be seen",
                count(self.pieces.len(), "piece"),
                count(self.sheets(), "sheet"),
                cm2(self.flat.surface_mm2()),
                100.0 * self.visible_share()
            ),
            format!(
                "stretch (mm on the surface for 1 mm on paper, or the inverse): mean {:.3}, 99th percentile {:.3}, largest {:.2}",
                self.flat.mean_stretch, self.flat.stretch_99, self.flat.largest_stretch
            ),
            format!(
                "{:.1} m to cut, {} with letters",
                self.cut_mm() / 1000.0,
                count(self.seams.len(), "seam")
            ),
        ];
        facts.extend(left_out_facts(&self.flat.left_out));
        facts
    }
}

/// Formats an area in the unit of the facts.
pub fn cm2(mm2: f64) -> String {
    format!("{:.1} cm²", mm2 / 100.0)
}

/// Returns a sentence for each part of the paint that is on no piece and visible.
pub fn left_out_facts(parts: &[LeftOut]) -> impl Iterator<Item = String> {
    let seen = parts.iter().filter(|part| part.surface_mm2 >= 0.5);
    seen.map(|part| format!("left out: {} {}", cm2(part.surface_mm2), reason(part.reason)))
}

/// Returns the reason why paint is on no piece, as a clause after its area.
pub fn reason(reason: LeftOutReason) -> &'static str {
    match reason {
        LeftOutReason::Hidden => "that cannot be seen from outside",
        LeftOutReason::NoArea => "of triangles without area or that are there twice",
        LeftOutReason::TooSmall => "of small parts, to stay within the number of pieces",
    }
}
