//! The sheets to paint by number: the border of every patch of one paint, and the paint's number in it.

use super::plane::mm;
use super::regions::CellGrid;
use super::stencil_sheet::registration;
use crate::print::sheet::{Mark, Sheet};
use crate::print::template::{Captions, SheetLayout, SheetPlan, around, guides};

const BORDER_MM: f64 = 0.2;
const NUMBER_MM: f64 = 4.0;
/// Of a cell's width, at most.
const NUMBER_SHARE: f64 = 0.6;

/// One sheet, cut at its part of the panel; the part lies on the page where the stencils of this sheet have it.
pub fn sheet(layout: &SheetLayout, plan: &SheetPlan, grid: &CellGrid, captions: &Captions) -> Sheet {
    let outer = plan.trim;
    let rim = plan.own.left_mm - plan.carried.left_mm;
    let part = outer.grown(-rim);
    let at = |x_mm: f64, y_mm: f64| {
        (
            outer.left_mm + x_mm - plan.carried.left_mm,
            outer.top_mm + y_mm + plan.carried.top_mm,
        )
    };
    let mut marks = Vec::new();
    for (a, b) in grid.borders(plan.own) {
        marks.push(Mark::line(at(mm(a.x), mm(a.y)), at(mm(b.x), mm(b.y)), BORDER_MM));
    }
    for patch in grid.patches(plan.own) {
        let text = (patch.paint + 1).to_string();
        let largest = NUMBER_MM.min(NUMBER_SHARE * patch.room_mm.1);
        let room = (largest, NUMBER_SHARE * patch.room_mm.0);
        marks.push(Mark::centred(at(patch.at_mm.0, patch.at_mm.1), room, text));
    }
    let cut_here = SheetPlan {
        trim: part,
        printed: part,
        ..plan.clone()
    };
    marks.extend(guides(layout, &cut_here));
    marks.extend(registration(outer, rim, 0.0));
    marks.extend(around(layout, plan, captions));
    layout.frame.sheet(part, part, marks)
}
