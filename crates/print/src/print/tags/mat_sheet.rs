//! The sheets of the ground mat, put together as those of the tiled template: cut at the crop marks, each sheet's strip beyond the
//! dashed line goes under the next.

use super::captions;
use super::ground::Ground;
use super::window::GroundWindow;
use crate::print::page::Media;
use crate::print::sheet::{Mark, PointMm, RectMm, Sheet, TextAnchor};
use crate::print::template::{SheetPlan, guides};
use scaleproof_plot::lettering::width_mm;
use scaleproof_pose::scene::Scene;

/// The pages of the mat, row by row from the top left.
pub fn sheets(ground: &Ground, scene: &Scene, media: Media) -> Vec<Sheet> {
    let page = ground.layout.frame;
    let how_to = [
        "Cut at the crop marks. A strip beyond a dashed line goes under the next sheet; seams that meet have the same letter.",
        "Ground mat seen from above, the model's front to the right; stand the model and the tent cards on their outlines.",
    ];
    let captions = captions(scene, media, how_to);
    let sheet = |plan: &SheetPlan| {
        let label = format!("mat {}", plan.id());
        page.labelled(plan.trim, marks(ground, plan), &captions, &label)
    };
    ground.layout.sheets.iter().map(sheet).collect()
}

fn marks(ground: &Ground, plan: &SheetPlan) -> Vec<Mark> {
    let carried = ground.ground(plan.carried);
    let window = GroundWindow {
        centre: PointMm::new(carried.left_mm, carried.top_mm),
        at: PointMm::new(plan.printed.left_mm, plan.printed.top_mm),
        right: [1.0, 0.0],
        scale: 1.0,
    };
    let mut marks = ground.mat.marks(&window, plan.printed);
    for label in &ground.mat.labels {
        let at = window.on_page(label.at);
        let half = 0.5 * width_mm(&label.text, label.size_mm);
        let room = RectMm::new(at.x_mm - half, at.y_mm, at.x_mm + half, at.y_mm + label.size_mm);
        // A text across a cut stands on both sheets, so that it is whole once they are glued.
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
