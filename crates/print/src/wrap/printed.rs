//! Printed panels of a model.

use super::panel::Panel;
use crate::sheet::Sheet;
use crate::template::{SheetLayout, SheetPlan};
use scaleproof_core::geometry::Point2;
use scaleproof_core::spelling::count;

#[derive(Debug, Clone)]
pub struct SpreadPanel {
    pub panel: Panel,
    pub layout: SheetLayout,
    /// (u, v) of the top-left corner of the layout's template, mm.
    pub corner: Point2,
}

impl SpreadPanel {
    /// Returns the page position of (u, v) = (0, 0) on a sheet: the offset from the plane to the page.
    pub fn moved_by_mm(&self, plan: &SheetPlan) -> Point2 {
        moved_by_mm(plan, self.corner)
    }
}

/// Returns the page position of (u, v) = (0, 0) on a sheet whose template's top-left corner is at `corner` of the plane.
pub fn moved_by_mm(plan: &SheetPlan, corner: Point2) -> Point2 {
    [
        plan.printed.left_mm - plan.carried.left_mm - corner[0],
        plan.printed.top_mm + plan.carried.top_mm - corner[1],
    ]
}

#[derive(Debug, Clone)]
pub struct Wrap {
    pub pieces: Vec<SpreadPanel>,
    /// Area of the paint on the surface.
    pub surface_mm2: f64,
    /// Length of the seams between panels without room for a letter.
    pub unlettered_mm: f64,
    pub cell_mm: Option<f64>,
    /// The instructions, then the sheets of each piece, corrected for the printer.
    pub pages: Vec<Sheet>,
}

impl Wrap {
    /// Returns a name for each page, used if it becomes a file of its own.
    pub fn page_names(&self) -> Vec<String> {
        let mut names = vec!["assembly".to_owned()];
        for SpreadPanel { panel, layout, .. } in &self.pieces {
            let name = |plan: &SheetPlan| format!("{}-{}", panel.side.name(), plan.id());
            names.extend(layout.sheets.iter().map(name));
        }
        names
    }

    /// Returns the largest length on the surface for 1 mm on paper.
    pub fn largest_stretch(&self) -> f64 {
        self.pieces.iter().map(|p| p.panel.largest_stretch).fold(1.0, f64::max)
    }

    /// Returns the area of the surface over its area on paper, every layer counted.
    pub fn mean_stretch(&self) -> f64 {
        let sum = |of: fn(&Panel) -> f64| self.pieces.iter().map(|p| of(&p.panel)).sum::<f64>();
        sum(|p| p.surface_mm2) / sum(|p| p.projected_mm2)
    }

    /// Returns the area of the paint that faces down and is on no panel.
    pub fn unprinted_mm2(&self) -> f64 {
        let printed = self.pieces.iter().map(|p| p.panel.surface_mm2).sum::<f64>();
        (self.surface_mm2 - printed).max(0.0)
    }

    pub fn facts(&self) -> Vec<String> {
        let cm2 = |mm2: f64| format!("{:.1} cm²", mm2 / 100.0);
        let mut facts: Vec<String> = Vec::new();
        for SpreadPanel { panel, layout, .. } in &self.pieces {
            let sheets = count(layout.sheets.len(), "sheet");
            let hidden = match panel.hidden_mm2() {
                mm2 if mm2 < 1.0 => String::new(),
                mm2 => format!(", {mm2:.0} mm² lie behind it and are printed with it"),
            };
            facts.push(format!(
                "{}: {} on paper for {} of surface, stretch up to {:.2}{hidden}, {sheets}",
                panel.side.name(),
                cm2(panel.flat_mm2()),
                cm2(panel.surface_mm2),
                panel.largest_stretch,
            ));
        }
        facts.push(format!(
            "largest stretch {:.2}, mean {:.3} (mm on the surface for 1 mm on paper); {:.1} % of the paint ({}) looks down and is on no \
             panel",
            self.largest_stretch(),
            self.mean_stretch(),
            100.0 * self.unprinted_mm2() / self.surface_mm2,
            cm2(self.unprinted_mm2()),
        ));
        facts
    }
}
