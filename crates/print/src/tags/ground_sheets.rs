//! Drawing of the ground: the sheets of the mat, assembled as those of the tiled template (cut at the crop marks, each sheet's strip beyond the
//! dashed line goes under the next), and the place strips, each a window onto the ground drawing.

use super::ground::Ground;
use super::mat::GroundWindow;
use super::piece::CutPiece;
use super::strip::{PlaceStrip, WIDTH_MM};
use super::{Instead, LINE_MM, captions};
use crate::media::Media;
use crate::sheet::{BLACK, Mark, RectMm, Sheet, TextAnchor};
use crate::template::{SheetPlan, guides};
use scaleproof_core::geometry::Point2;
use scaleproof_plot::lettering::width_mm;
use scaleproof_pose::scene::Scene;

/// Font sizes of a strip's name and its other text, and the distance of text from its edges.
const NAME_MM: f64 = 6.0;
const TEXT_MM: f64 = 2.4;
const EDGE_MM: f64 = 2.0;

/// Draws the pages of the mat, row by row from the top left.
pub fn sheets(ground: &Ground, scene: &Scene, media: Media) -> Vec<Sheet> {
    let page = ground.layout.frame;
    let how_to = [
        "Cut at the crop marks. A strip beyond a dashed line goes under the next sheet; seams that meet have the same letter.",
        "Ground mat seen from above, the model's front to the right; stand the model and the tent cards on their outlines.",
    ];
    let captions = captions(scene, media, how_to);
    let sheet = |plan: &SheetPlan| {
        let label = format!("mat {}", plan.id());
        page.labelled(plan.trim, mat_marks(ground, plan), &captions, &label)
    };
    ground.layout.sheets.iter().map(sheet).collect()
}

fn mat_marks(ground: &Ground, plan: &SheetPlan) -> Vec<Mark> {
    let carried = ground.ground(plan.carried);
    let corner = [plan.printed.left_mm, plan.printed.top_mm];
    let window = GroundWindow::level([carried.left_mm, carried.top_mm], corner, 1.0);
    let mut marks = ground.mat.marks(&window, plan.printed);
    for label in &ground.mat.labels {
        let at = window.on_page(label.at);
        let half = 0.5 * width_mm(&label.text, label.size_mm);
        let room = RectMm::new(at[0] - half, at[1], at[0] + half, at[1] + label.size_mm);
        // A text across a cut is on both sheets, so that it is complete once they are glued.
        if overlap(&room, &plan.trim) {
            let text = Mark::text(at, label.size_mm, TextAnchor::Centre, label.text.as_str());
            marks.push(Mark::clipped(plan.printed, vec![text]));
        }
    }
    marks.extend(guides(&ground.layout, plan));
    marks
}

fn overlap(a: &RectMm, b: &RectMm) -> bool {
    a.left_mm < b.right_mm && b.left_mm < a.right_mm && a.bottom_mm < b.top_mm && b.bottom_mm < a.top_mm
}

pub fn strips<'a>(ground: &'a Ground) -> Vec<CutPiece<'a>> {
    let piece = |strip: &'a PlaceStrip| CutPiece {
        size_mm: (strip.length_mm, WIDTH_MM),
        name: format!("strip T{}", strip.tent + 1),
        what: format!("the place strip of tent card T{}", strip.tent + 1),
        instead: Instead::WholeMat,
        draw: Box::new(move |at| Ok(strip_marks(strip, ground, at))),
    };
    ground.strips.iter().map(piece).collect()
}

fn strip_marks(strip: &PlaceStrip, ground: &Ground, at: Point2) -> Vec<Mark> {
    let area = strip.area(at);
    let mut marks = ground.mat.marks(&strip.window(at), area);
    let name = format!("T{}", strip.tent + 1);
    // Free part between the glued root and the end beneath the card.
    let free = (area.left_mm + strip.root_mm, area.right_mm - strip.under_mm);
    let middle = [(free.0 + free.1) / 2.0, area.middle()[1]];
    let size = (NAME_MM, (free.1 - free.0 - 2.0).max(2.0));
    marks.push(Mark::centred(middle, size, name.as_str()));
    let corner = [area.left_mm + EDGE_MM, area.bottom_mm + EDGE_MM];
    let glue = format!("glue onto strip {name}");
    marks.push(Mark::text(corner, TEXT_MM, TextAnchor::Left, glue));
    let ends = [
        (area.bottom_mm, area.bottom_mm + EDGE_MM),
        (area.top_mm - EDGE_MM, area.top_mm),
    ];
    marks.extend(ends.map(|(from, to)| Mark::line([free.0, from], [free.0, to], LINE_MM)));
    marks.extend(Mark::outline(&area.outline(), LINE_MM, BLACK));
    marks
}
