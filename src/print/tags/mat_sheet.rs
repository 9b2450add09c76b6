//! Spreads the ground mat over sheets, as the tiled template is: cut at the crop marks, each sheet's strip beyond the dashed line
//! goes under the next.

use super::mat::Mat;
use super::{TagPrintError, captions};
use crate::print::lettering::width_mm;
use crate::print::page::{MARGIN_MM, Media, Page};
use crate::print::paper::Orientation;
use crate::print::shapes::clipped;
use crate::print::sheet::{Anchor, Mark, PointMm, RectMm, Sheet};
use crate::print::template::{Layout, LayoutRequest, SheetPlan, guides, layout};
use crate::scene::Scene;

/// What neighbouring sheets share for gluing.
const OVERLAP_MM: f64 = 8.0;

/// The pages of the mat, row by row from the top left.
pub fn sheets(mat: &Mat, scene: &Scene, media: Media) -> Result<Vec<Sheet>, TagPrintError> {
    let layout = layout(&LayoutRequest {
        size_mm: mat.size_mm,
        paper: media.paper.into(),
        orientation: Orientation::Auto,
        overlap_mm: OVERLAP_MM,
        bleed_mm: 0.0,
        margin_mm: MARGIN_MM,
        printer: media.printer,
    })?;
    let page = Page(layout.frame);
    let how_to = [
        "Cut at the crop marks. A strip beyond a dashed line goes under the next sheet; seams that meet have the same letter.",
        "Ground mat seen from above, the model's front to the right; stand the model and the tent cards on their outlines.",
    ];
    let sheet = |plan: &SheetPlan| {
        let label = format!("mat {} of {}×{}", plan.id(), layout.rows, layout.columns);
        page.cut_sheet(
            plan.trim,
            marks(mat, &layout, plan),
            &captions(scene, media, how_to),
            &label,
        )
    };
    Ok(layout.sheets.iter().map(sheet).collect())
}

fn marks(mat: &Mat, layout: &Layout, plan: &SheetPlan) -> Vec<Mark> {
    // The plan's regions count from the mat's top left corner, y down.
    let on_page = |p: &PointMm| {
        PointMm::new(
            plan.printed.left_mm + (p.x_mm - plan.carried.left_mm),
            plan.printed.top_mm - (mat.size_mm.1 - p.y_mm - plan.carried.top_mm),
        )
    };
    let mut marks = Vec::new();
    for shape in &mat.shapes {
        let moved = shape
            .outlines
            .iter()
            .map(|outline| outline.iter().map(on_page).collect::<Vec<_>>());
        let outlines: Vec<_> = moved
            .map(|o| clipped(&o, plan.printed))
            .filter(|o| o.len() > 2)
            .collect();
        if !outlines.is_empty() {
            marks.push(Mark::Area {
                outlines,
                colour: shape.colour,
            });
        }
    }
    for label in &mat.labels {
        let at = on_page(&label.at);
        let half = 0.5 * width_mm(&label.text, label.size_mm);
        let room = RectMm::new(at.x_mm - half, at.y_mm, at.x_mm + half, at.y_mm + label.size_mm);
        // A text across a cut stands on both sheets, so that it is whole once they are glued.
        if overlap(&room, &plan.trim) {
            marks.push(Mark::text(
                (at.x_mm, at.y_mm),
                label.size_mm,
                Anchor::Centre,
                label.text.clone(),
            ));
        }
    }
    marks.extend(guides(layout, plan));
    marks
}

fn overlap(a: &RectMm, b: &RectMm) -> bool {
    a.left_mm < b.right_mm && b.left_mm < a.right_mm && a.bottom_mm < b.top_mm && b.bottom_mm < a.top_mm
}
