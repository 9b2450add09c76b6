//! Sheets of one part of the panel: to paint by number, with the border of every patch of one paint and the paint's number in it; and the stencils,
//! with tinted openings to cut out, and a rim with a label. Registration holes are at the same place on all of them.

use super::plane::{self, PlaneOutline, place};
use super::regions::CellGrid;
use super::{PaintRequest, Stencil};
use crate::sheet::{BLACK, Line, Mark, RectMm, Sheet, Srgb8, Text, TextAnchor};
use crate::template::{Captions, Front, SheetLayout, SheetPlan, TemplateRequest, around, guides};
use scaleproof_core::geometry::{Point2, circle};
use scaleproof_plot::lettering::printable;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::Paint;

/// Colour of openings to cut out: light, to save ink, and distinct from lines and text.
pub const OPENING: Srgb8 = [255, 214, 140];
const LINE_MM: f64 = 0.15;
const BORDER_MM: f64 = 0.2;
const NUMBER_MM: f64 = 4.0;
/// Maximum height and width of a number, as a share of its cell's.
const NUMBER_SHARE: f64 = 0.6;
const LABEL_MM: f64 = 3.5;
const HOLE_MM: f64 = 3.0;
/// Number of corners of a registration hole.
const HOLE_CORNERS: u32 = 24;

pub fn hole_mm(min_feature_mm: f64) -> f64 {
    HOLE_MM.max(min_feature_mm)
}

/// Draws crosses in the corners of a rim; with a hole, only the arms beside it.
pub fn registration(outer: RectMm, rim_mm: f64, hole_mm: f64) -> Vec<Mark> {
    let (near, far) = (0.5 * hole_mm, 0.5 * rim_mm - 0.5);
    let crosses = corners(outer, rim_mm).flat_map(|middle| cross(middle, near, far));
    crosses.collect()
}

pub fn cross([x, y]: Point2, near: f64, far: f64) -> [Mark; 4] {
    [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
        .map(|[dx, dy]| Mark::line([x + near * dx, y + near * dy], [x + far * dx, y + far * dy], LINE_MM))
}

pub fn disc(middle: Point2, radius: f64) -> Vec<Point2> {
    circle(middle, radius, HOLE_CORNERS).collect()
}

fn corners(outer: RectMm, rim_mm: f64) -> impl Iterator<Item = Point2> {
    outer.grown(-0.5 * rim_mm).outline().into_iter()
}

/// Draws one sheet to paint by number, cut at its part of the panel, which has the same place on the page as on the stencils of this sheet.
pub fn numbers(layout: &SheetLayout, plan: &SheetPlan, grid: &CellGrid, captions: &Captions) -> Sheet {
    let outer = plan.trim;
    let rim = plan.own.left_mm - plan.carried.left_mm;
    let part = outer.grown(-rim);
    let mut marks = Vec::new();
    for (a, b) in grid.borders(plan.own) {
        marks.push(Mark::line(plan.on_page(place(a)), plan.on_page(place(b)), BORDER_MM));
    }
    for patch in grid.patches(plan.own) {
        let text = (patch.paint + 1).to_string();
        let largest = NUMBER_MM.min(NUMBER_SHARE * patch.room_mm.1);
        let room = (largest, NUMBER_SHARE * patch.room_mm.0);
        marks.push(Mark::centred(plan.on_page(patch.at_mm), room, text));
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

/// Drawing of the stencils of one request.
pub struct StencilPen<'a> {
    layout: &'a SheetLayout,
    captions: Captions,
    min_feature_mm: f64,
    mirror: bool,
}

impl<'a> StencilPen<'a> {
    pub fn new(layout: &'a SheetLayout, pattern: &Pattern, request: &PaintRequest, cell_mm: f64) -> Self {
        let template = &request.template;
        let front = match (request.mirror, template.front) {
            (true, Front::Left) => Front::Right,
            (true, Front::Right) => Front::Left,
            (_, front) => front,
        };
        let seen = TemplateRequest {
            front,
            ..template.clone()
        };
        Self {
            layout,
            captions: Captions::new(pattern, &seen, cell_mm),
            min_feature_mm: request.min_feature_mm,
            mirror: request.mirror,
        }
    }

    /// Draws the page of one paint and one part of the panel. `number`: the paint's in the legend.
    pub fn sheet(&self, plan: &SheetPlan, number: usize, paint: &Paint, stencil: &Stencil) -> Sheet {
        let outer = plan.trim;
        let rim = plan.own.left_mm - plan.carried.left_mm;
        let place = |outline: &PlaneOutline| outline.iter().map(|p| plan.on_page(plane::place(*p))).collect();
        let hole_mm = hole_mm(self.min_feature_mm);
        let holes = corners(outer, rim).map(|middle| disc(middle, 0.5 * hole_mm));
        let openings: Vec<Vec<Point2>> = stencil.openings.outlines().map(place).chain(holes).collect();
        let mut marks = vec![
            Mark::Area {
                outlines: openings.clone(),
                colour: OPENING,
            },
            Mark::Cut {
                outlines: openings,
                is_piece: false,
            },
        ];
        marks.extend(registration(outer, rim, hole_mm));
        marks.extend(Mark::outline(&outer.outline(), LINE_MM, BLACK));
        marks.push(self.label(plan, rim, number, paint));
        marks.extend(guides(self.layout, plan));
        if self.mirror {
            marks = marks.into_iter().map(|mark| mirrored(mark, outer)).collect();
        }
        marks.extend(around(self.layout, plan, &self.captions));
        self.layout.frame.sheet(outer, outer, marks)
    }

    /// Draws the label that stays on the stencil when its page is cut away.
    fn label(&self, plan: &SheetPlan, rim: f64, number: usize, paint: &Paint) -> Mark {
        let outer = plan.trim;
        let side = if self.mirror {
            " · MIRRORED, cut from the back"
        } else {
            ""
        };
        let text = printable(&format!(
            "Paint {number}: {} · sheet {} · this edge up{side}",
            paint.name,
            plan.id()
        ));
        let middle = [outer.middle()[0], outer.top_mm - 0.5 * rim];
        Mark::centred(middle, (LABEL_MM, outer.width_mm() - 2.0 * rim), text)
    }
}

/// Mirrors a mark as seen from the back of the piece; text stays readable. Fills, stamps, images and clipped marks, which stencils do not have, are
/// unchanged.
pub fn mirrored(mut mark: Mark, piece: RectMm) -> Mark {
    let turn = |p: &mut Point2| p[0] = piece.left_mm + piece.right_mm - p[0];
    match &mut mark {
        Mark::Line(Line { from, to, .. }) => [from, to].into_iter().for_each(turn),
        Mark::Text(Text { at, anchor, .. }) => {
            turn(at);
            *anchor = match anchor {
                TextAnchor::Left => TextAnchor::Right,
                TextAnchor::Centre => TextAnchor::Centre,
                TextAnchor::Right => TextAnchor::Left,
            };
        }
        Mark::Area { outlines, .. } | Mark::Cut { outlines, .. } => {
            // Reversed, so that outlines keep their direction.
            outlines.iter_mut().for_each(|outline| outline.reverse());
            outlines.iter_mut().flatten().for_each(turn);
        }
        Mark::Fill(_) | Mark::Stamped { .. } | Mark::Clipped { .. } | Mark::Image { .. } => {}
    }
    mark
}
