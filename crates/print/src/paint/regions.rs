//! Cells of a panel as rectangles, runs and connected regions. Areas are in the template's frame with y turned up: (x, -y) of [`TemplateRect`], in
//! [`plane`](super::plane) units.

use std::ops::Range;

use super::plane::{Bounds, PlaneOutline, PlanePoint, mm, units};
use crate::template::TemplateRect;
use scaleproof_core::geometry::Point2;
use scaleproof_core::geometry::{cells_beside, stretches};
use scaleproof_surface::pattern::palette::Painted;

/// Pattern in paints, repeated over a panel from its top-left corner.
#[derive(Debug, Clone, Copy)]
pub struct CellGrid<'a> {
    pub painted: &'a Painted,
    pub cell_mm: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct PaintPatch {
    pub paint: usize,
    /// Centre and size of the part of a cell that is farthest from the patch's border.
    pub at_mm: Point2,
    pub room_mm: (f64, f64),
}

pub fn bounds(region: TemplateRect) -> Bounds {
    let [left, bottom, right, top] = [region.left_mm, -region.bottom_mm, region.right_mm, -region.top_mm].map(units);
    Bounds::new(left, bottom, right, top)
}

pub fn rectangle_mm2(corners: &PlaneOutline) -> f64 {
    match corners[..] {
        [a, _, b, _] => mm(b.x - a.x) * mm(b.y - a.y),
        _ => 0.0,
    }
}

impl CellGrid<'_> {
    /// Returns the ranges of columns and of rows that reach into a region.
    pub fn cells(&self, region: TemplateRect) -> (Range<usize>, Range<usize>) {
        // The visible part of a cell must be at least a unit: seams on borders of cells are rounded.
        let range = |from: f64, to: f64| {
            let first = (from.max(0.0) / self.cell_mm).floor() as usize;
            let ends = |i: &usize| units(*i as f64 * self.cell_mm);
            let first = first + usize::from(ends(&(first + 1)) <= units(from));
            first..(first..).find(|i| ends(i) >= units(to)).unwrap_or(first)
        };
        let columns = range(region.left_mm, region.right_mm);
        (columns, range(region.top_mm, region.bottom_mm))
    }

    /// Returns the part of some columns and rows inside a region.
    fn part(&self, region: Bounds, columns: Range<usize>, rows: Range<usize>) -> Bounds {
        let edge = |i: usize| units(i as f64 * self.cell_mm);
        Bounds::new(
            edge(columns.start).max(region.left),
            (-edge(rows.end)).max(region.bottom),
            edge(columns.end).min(region.right),
            (-edge(rows.start)).min(region.top),
        )
    }

    /// Returns a paint's cells in a region: a rectangle for each run of cells in a row. They share only borders.
    pub fn runs(&self, paint: usize, region: TemplateRect) -> Vec<PlaneOutline> {
        let (columns, rows) = self.cells(region);
        let whole = bounds(region);
        let in_row = |row: usize| {
            let is_paint = |column: &usize| self.painted.paint_at(*column, row) == paint;
            let runs = stretches(columns.clone(), is_paint).into_iter();
            runs.map(move |run| self.part(whole, run, row..row + 1).outline())
        };
        rows.flat_map(in_row).collect()
    }

    /// Returns the lines between cells of different paints, and around the region.
    pub fn borders(&self, region: TemplateRect) -> Vec<(PlanePoint, PlanePoint)> {
        let (columns, rows) = self.cells(region);
        let whole = bounds(region);
        let paint = |column: usize, row: usize| self.painted.paint_at(column, row);
        let mut lines = Vec::new();
        for row in rows.clone().skip(1) {
            let differ = |column: &usize| paint(*column, row) != paint(*column, row - 1);
            for run in stretches(columns.clone(), differ) {
                let part = self.part(whole, run, row..row + 1);
                lines.push(([part.left, part.top], [part.right, part.top]));
            }
        }
        for column in columns.skip(1) {
            let differ = |row: &usize| paint(column, *row) != paint(column - 1, *row);
            for run in stretches(rows.clone(), differ) {
                let part = self.part(whole, column..column + 1, run);
                lines.push(([part.left, part.top], [part.left, part.bottom]));
            }
        }
        let line = |([x1, y1], [x2, y2]): ([i32; 2], [i32; 2])| (PlanePoint::new(x1, y1), PlanePoint::new(x2, y2));
        let around = whole.outline();
        super::plane::edges(&around)
            .chain(lines.into_iter().map(line))
            .collect()
    }

    /// Returns the patches of a region (cells connected by sides), row by row of their first cells.
    pub fn patches(&self, region: TemplateRect) -> Vec<PaintPatch> {
        let (columns, rows) = self.cells(region);
        let (wide, high) = (columns.len(), rows.len());
        let paint = |i: usize| self.painted.paint_at(columns.start + i % wide, rows.start + i / wide);
        let inside = depths(wide, high, paint);
        let whole = bounds(region);
        let mut seen = vec![false; wide * high];
        let mut patches = Vec::new();
        for first in 0..wide * high {
            if seen[first] {
                continue;
            }
            let part = |i: usize| {
                let (column, row) = (columns.start + i % wide, rows.start + i / wide);
                self.part(whole, column..column + 1, row..row + 1)
            };
            let size = |i: usize| mm((part(i).right - part(i).left).min(part(i).top - part(i).bottom));
            let mut best = first;
            for (i, _) in flooded(vec![first], wide, high, &mut seen, |i| paint(i) == paint(first)) {
                // The deepest cell, and of equal ones the one with the most room at the panel's edge.
                if (inside[i], size(i)) > (inside[best], size(best)) {
                    best = i;
                }
            }
            let room = part(best);
            patches.push(PaintPatch {
                paint: paint(first),
                at_mm: [mm(room.left + room.right) / 2.0, mm(room.bottom + room.top) / 2.0],
                room_mm: (mm(room.right - room.left), mm(room.top - room.bottom)),
            });
        }
        patches
    }
}

/// Returns the cells reachable from the first ones through cells with `alike`, each with its number of steps; marks them as seen.
fn flooded(
    first: Vec<usize>,
    wide: usize,
    high: usize,
    seen: &mut [bool],
    alike: impl Fn(usize) -> bool,
) -> Vec<(usize, u32)> {
    first.iter().for_each(|i| seen[*i] = true);
    let mut found: Vec<(usize, u32)> = first.into_iter().map(|i| (i, 0)).collect();
    let mut next = 0;
    while let Some((cell, steps)) = found.get(next).copied() {
        for i in cells_beside(cell, wide, high).into_iter().flatten() {
            if !seen[i] && alike(i) {
                seen[i] = true;
                found.push((i, steps + 1));
            }
        }
        next += 1;
    }
    found
}

/// Returns each cell's number of steps from the nearest cell of another paint, or from the outside.
fn depths(wide: usize, high: usize, paint: impl Fn(usize) -> usize) -> Vec<u32> {
    let is_other = |n: &Option<usize>, i: usize| n.is_none_or(|n| paint(n) != paint(i));
    let at_border = |i: &usize| cells_beside(*i, wide, high).iter().any(|n| is_other(n, *i));
    let border = (0..wide * high).filter(at_border).collect();
    let mut depth = vec![0; wide * high];
    for (i, steps) in flooded(border, wide, high, &mut vec![false; wide * high], |_| true) {
        depth[i] = steps;
    }
    depth
}
