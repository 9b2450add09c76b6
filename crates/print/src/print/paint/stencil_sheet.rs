//! A stencil on its sheet: openings tinted, to be cut out; the rim with its label, and registration holes at the same place for every
//! paint.

use super::plane::{PlaneOutline, mm};
use super::{PaintRequest, Stencil};
use crate::print::sheet::{Mark, PointMm, RectMm, Sheet, Srgb8, TextAnchor};
use crate::print::template::{Captions, Front, SheetLayout, SheetPlan, TemplateRequest, around, guides};
use scaleproof_plot::lettering::{CAP_HEIGHT, fitting_size_mm, printable};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::Paint;

/// What is to be cut out: light, to spare ink, and no colour of lines and text.
pub const OPENING: Srgb8 = [255, 214, 140];
const LINE_MM: f64 = 0.15;
const LABEL_MM: f64 = 3.5;
const HOLE_MM: f64 = 3.0;
/// Corners of a registration hole.
const HOLE_CORNERS: u32 = 24;

/// Width of a registration hole.
pub fn hole_mm(min_feature_mm: f64) -> f64 {
    HOLE_MM.max(min_feature_mm)
}

/// Crosses in the corners of a rim; with a hole, only the arms beside it.
pub fn registration(outer: RectMm, rim_mm: f64, hole_mm: f64) -> Vec<Mark> {
    let (near, far) = (0.5 * hole_mm, 0.5 * rim_mm - 0.5);
    let middles = corners(outer, rim_mm).into_iter();
    middles.flat_map(|middle| cross(middle, near, far)).collect()
}

/// The arms of a cross, from near its middle to far from it.
pub fn cross((x, y): (f64, f64), near: f64, far: f64) -> [Mark; 4] {
    [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
        .map(|(dx, dy)| Mark::line((x + near * dx, y + near * dy), (x + far * dx, y + far * dy), LINE_MM))
}

/// A round hole.
pub fn disc((x, y): (f64, f64), radius: f64) -> Vec<PointMm> {
    let turn = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(HOLE_CORNERS);
    let corner = |i: u32| PointMm::new(x + radius * turn(i).cos(), y + radius * turn(i).sin());
    (0..HOLE_CORNERS).map(corner).collect()
}

/// The middles of a rim's corners.
fn corners(outer: RectMm, rim_mm: f64) -> [(f64, f64); 4] {
    let (left, right) = (outer.left_mm + 0.5 * rim_mm, outer.right_mm - 0.5 * rim_mm);
    let (bottom, top) = (outer.bottom_mm + 0.5 * rim_mm, outer.top_mm - 0.5 * rim_mm);
    [(left, bottom), (right, bottom), (right, top), (left, top)]
}

/// Draws the stencils of one request.
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

    /// The page of one paint and one part of the panel. `number`: the paint's in the legend.
    pub fn sheet(&self, plan: &SheetPlan, number: usize, paint: &Paint, stencil: &Stencil) -> Sheet {
        let outer = plan.trim;
        let rim = plan.own.left_mm - plan.carried.left_mm;
        let openings = self.openings(plan, rim, stencil);
        let mut marks = vec![Mark::Area {
            outlines: openings.clone(),
            colour: OPENING,
        }];
        marks.push(Mark::Cut {
            outlines: openings,
            is_piece: false,
        });
        marks.extend(registration(outer, rim, hole_mm(self.min_feature_mm)));
        marks.extend(outline(outer));
        marks.push(self.label(plan, rim, number, paint));
        marks.extend(guides(self.layout, plan));
        if self.mirror {
            marks = marks.into_iter().map(|mark| mirrored(mark, outer)).collect();
        }
        marks.extend(around(self.layout, plan, &self.captions));
        self.layout.frame.sheet(outer, outer, marks)
    }

    /// Those of the paint, and the registration holes.
    fn openings(&self, plan: &SheetPlan, rim: f64, stencil: &Stencil) -> Vec<Vec<PointMm>> {
        let outer = plan.trim;
        let place = |outline: &PlaneOutline| -> Vec<PointMm> {
            let corner = |p: &super::plane::PlanePoint| {
                PointMm::new(
                    outer.left_mm + mm(p.x) - plan.carried.left_mm,
                    outer.top_mm + mm(p.y) + plan.carried.top_mm,
                )
            };
            outline.iter().map(corner).collect()
        };
        let radius = 0.5 * hole_mm(self.min_feature_mm);
        let holes = corners(outer, rim).into_iter().map(|middle| disc(middle, radius));
        stencil.openings.outlines().map(place).chain(holes).collect()
    }

    /// What stays on the stencil when its page is cut away.
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
        let size_mm = fitting_size_mm(&text, LABEL_MM, outer.width_mm() - 2.0 * rim);
        let middle = outer.top_mm - 0.5 * rim;
        let x = 0.5 * (outer.left_mm + outer.right_mm);
        Mark::text(
            (x, middle - 0.5 * CAP_HEIGHT * size_mm),
            size_mm,
            TextAnchor::Centre,
            text,
        )
    }
}

fn outline(r: RectMm) -> [Mark; 4] {
    let (a, b, c, d) = (
        (r.left_mm, r.bottom_mm),
        (r.right_mm, r.bottom_mm),
        (r.right_mm, r.top_mm),
        (r.left_mm, r.top_mm),
    );
    [(a, b), (b, c), (c, d), (d, a)].map(|(from, to)| Mark::line(from, to, LINE_MM))
}

/// A mark as seen from the back of the piece; text stays readable.
pub fn mirrored(mark: Mark, piece: RectMm) -> Mark {
    let over = |p: PointMm| PointMm::new(piece.left_mm + piece.right_mm - p.x_mm, p.y_mm);
    // Turned back, so that outlines run the way they did.
    let outlines = |all: Vec<Vec<PointMm>>| {
        all.into_iter()
            .map(|o| o.into_iter().rev().map(over).collect())
            .collect()
    };
    match mark {
        Mark::Line {
            from,
            to,
            width_mm,
            dash_mm,
            colour,
        } => Mark::Line {
            from: over(from),
            to: over(to),
            width_mm,
            dash_mm,
            colour,
        },
        Mark::Text {
            at,
            size_mm,
            anchor,
            text,
            colour,
        } => Mark::Text {
            at: over(at),
            size_mm,
            anchor: match anchor {
                TextAnchor::Left => TextAnchor::Right,
                TextAnchor::Centre => TextAnchor::Centre,
                TextAnchor::Right => TextAnchor::Left,
            },
            text,
            colour,
        },
        Mark::Area { outlines: all, colour } => Mark::Area {
            outlines: outlines(all),
            colour,
        },
        Mark::Cut {
            outlines: all,
            is_piece,
        } => Mark::Cut {
            outlines: outlines(all),
            is_piece,
        },
        // A stencil has none of these.
        other @ (Mark::Fill(_) | Mark::Stamped { .. } | Mark::Clipped { .. } | Mark::Image { .. }) => other,
    }
}
