//! Filled outlines on a page: modules of a tag at any angle, strokes, triangles, and clipping.

use super::sheet::{RectMm, sides};
use scaleproof_core::geometry::{Point2, clip, extent, stretches};
use scaleproof_pose::tags::{Modules, TagImage};

/// Closed convex outline, counter-clockwise.
pub type OutlineMm = Vec<Point2>;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TagPlacement {
    pub centre: Point2,
    pub right: Point2,
    pub module_mm: f64,
}

impl TagPlacement {
    /// Creates the placement of a tag whose black border has this outer size.
    pub fn new(image: &TagImage, size_mm: f64, centre: Point2, right: Point2) -> Self {
        Self {
            centre,
            right,
            module_mm: size_mm / image.border_modules() as f64,
        }
    }

    /// Converts a point relative to the centre of the square (x right, y up, mm) to the page.
    pub fn at(&self, x_mm: f64, y_mm: f64) -> Point2 {
        let [c, s] = self.right;
        [
            self.centre[0] + c * x_mm - s * y_mm,
            self.centre[1] + s * x_mm + c * y_mm,
        ]
    }

    /// Returns a rectangle of the square's frame (x right, y up, from its centre) on the page.
    pub fn rectangle(&self, left: f64, bottom: f64, right: f64, top: f64) -> OutlineMm {
        [[left, bottom], [right, bottom], [right, top], [left, top]]
            .map(|[x, y]| self.at(x, y))
            .to_vec()
    }

    /// Returns a triangle that points up in the square's frame, its base centred at (`x_mm`, `y_mm`) from the centre.
    pub fn up_mark(&self, x_mm: f64, y_mm: f64, size_mm: f64) -> OutlineMm {
        let half = 0.5 * size_mm;
        vec![
            self.at(x_mm - half, y_mm),
            self.at(x_mm + half, y_mm),
            self.at(x_mm, y_mm + size_mm),
        ]
    }
}

/// Returns the black of a square of modules: one outline for each run of black modules in a row.
pub fn black_modules(modules: &Modules, place: &TagPlacement) -> Vec<OutlineMm> {
    let side = modules.side();
    let edge = |module: usize| (module as f64 - 0.5 * side as f64) * place.module_mm;
    let in_row = |row: usize| {
        let runs = stretches(0..side, |column| modules.is_black(row, *column)).into_iter();
        runs.map(move |run| place.rectangle(edge(run.start), -edge(row + 1), edge(run.end), -edge(row)))
    };
    (0..side).flat_map(in_row).collect()
}

/// Returns a straight stroke with butt ends.
pub fn stroke(from: Point2, to: Point2, width_mm: f64) -> OutlineMm {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let (x, y) = (-dy / length * width_mm / 2.0, dx / length * width_mm / 2.0);
    let beside = |p: Point2, side: f64| [p[0] + side * x, p[1] + side * y];
    vec![beside(from, -1.0), beside(to, -1.0), beside(to, 1.0), beside(from, 1.0)]
}

pub fn stroked(outline: &[Point2], width_mm: f64) -> Vec<OutlineMm> {
    sides(outline).map(|(a, b)| stroke(*a, *b, width_mm)).collect()
}

/// Clips a convex outline to a rectangle; empty if nothing is left.
pub fn clipped(outline: &[Point2], to: RectMm) -> OutlineMm {
    let rest = clip::clipped(outline, |p| p[0] - to.left_mm);
    let rest = clip::clipped(&rest, |p| to.right_mm - p[0]);
    let rest = clip::clipped(&rest, |p| p[1] - to.bottom_mm);
    clip::clipped(&rest, |p| to.top_mm - p[1])
}

/// Returns true if two convex outlines share more than a border, by the separating axis theorem.
pub fn overlap(a: &[Point2], b: &[Point2]) -> bool {
    /// Tolerance: shared borders are no overlap.
    const TOUCH_MM: f64 = 0.01;
    let edges =
        |outline: &[Point2]| -> Vec<Point2> { sides(outline).map(|(p, q)| [q[0] - p[0], q[1] - p[1]]).collect() };
    let mut axes = edges(a).into_iter().chain(edges(b)).filter(|[x, y]| x.hypot(*y) > 0.0);
    axes.all(|[x, y]| {
        let (nx, ny) = (-y / x.hypot(y), x / x.hypot(y));
        let span = |outline: &[Point2]| extent(outline.iter().map(|p| p[0] * nx + p[1] * ny));
        let ((low_a, high_a), (low_b, high_b)) = (span(a), span(b));
        low_a < high_b - TOUCH_MM && low_b < high_a - TOUCH_MM
    })
}
