//! Lines of panels and strips on a page.

use super::Point;
use super::region::{Contour, Region};
use crate::print::sheet::{BLACK, Mark, PointMm, Srgb8};
use crate::print::template::SheetPlan;

/// Between a panel's edge and the line it is cut along, so that none of the line stays on the piece.
const CUT_GAP_MM: f64 = 0.1;
const CUT_LINE_MM: f64 = 0.15;
/// Free paper that the line takes around a region, and a little more.
pub const CUT_ROOM_MM: f64 = 1.0;
/// Edges within a panel are marked lightly: they lie on the pattern.
pub const EDGE_LINE_MM: f64 = 0.06;
pub const EDGE_DASH_MM: (f64, f64) = (1.0, 6.0);

/// What a cutter follows on a sheet: the part of the region's border that the sheet shows.
pub fn cutter_path(region: &Region, by: Point, plan: &SheetPlan) -> Mark {
    let sheet = plan.printed.outline();
    let sheet = Region::union(vec![sheet.iter().map(|p| [p.x_mm - by[0], p.y_mm - by[1]]).collect()]);
    Mark::Cut {
        outlines: moved(region.and(&sheet).contours(), by),
        is_piece: true,
    }
}

/// The line around a region, outside of it.
pub fn cut_line(region: &Region, by: Point) -> Vec<Mark> {
    let around = region.grown(CUT_GAP_MM + 0.5 * CUT_LINE_MM);
    let mut marks = Vec::new();
    for outline in moved(around.contours(), by) {
        let next = outline.iter().cycle().skip(1);
        let lines = outline.iter().zip(next);
        marks.extend(lines.map(|(a, b)| line(*a, *b, CUT_LINE_MM, None, BLACK)));
    }
    marks
}

pub(super) fn line(from: PointMm, to: PointMm, width_mm: f64, dash_mm: Option<(f64, f64)>, colour: Srgb8) -> Mark {
    Mark::Line {
        from,
        to,
        width_mm,
        dash_mm,
        colour,
    }
}

pub(super) fn place(p: Point, by: Point) -> PointMm {
    PointMm::new(p[0] + by[0], p[1] + by[1])
}

/// Outlines of a plane, moved onto a page.
pub fn moved<'a>(outlines: impl Iterator<Item = &'a Contour>, by: Point) -> Vec<Vec<PointMm>> {
    outlines
        .map(|outline| outline.iter().map(|p| place(*p, by)).collect())
        .collect()
}
