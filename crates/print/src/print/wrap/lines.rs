//! Lines of panels and strips on a page.

use super::Point;
use super::region::{Contour, Region};
use crate::print::sheet::{Mark, PointMm};
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
    let around = moved(region.grown(CUT_GAP_MM + 0.5 * CUT_LINE_MM).contours(), by);
    let lines = around.iter().flat_map(|outline| Mark::outline(outline, CUT_LINE_MM));
    lines.collect()
}

/// A place of a plane on a page.
pub(super) fn place(p: Point, by: Point) -> PointMm {
    PointMm::new(p[0] + by[0], p[1] + by[1])
}

/// Outlines of a plane, moved onto a page.
pub fn moved<'a>(outlines: impl Iterator<Item = &'a Contour>, by: Point) -> Vec<Vec<PointMm>> {
    outlines
        .map(|outline| outline.iter().map(|p| place(*p, by)).collect())
        .collect()
}
