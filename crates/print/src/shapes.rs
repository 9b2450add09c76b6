//! Filled outlines on a page: modules of a tag at any angle, strokes, triangles, and clipping.

use super::sheet::{PointMm, RectMm, sides};
use scaleproof_core::geometry::{extent, stretches};
use scaleproof_pose::tags::{Modules, TagImage};

/// Closed convex outline, counter-clockwise.
pub type OutlineMm = Vec<PointMm>;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TagPlacement {
    pub centre: PointMm,
    pub right: [f64; 2],
    pub module_mm: f64,
}

impl TagPlacement {
    /// Creates the placement of a tag whose black border has this outer size.
    pub fn new(image: &TagImage, size_mm: f64, centre: PointMm, right: [f64; 2]) -> Self {
        Self {
            centre,
            right,
            module_mm: size_mm / image.border_modules() as f64,
        }
    }

    /// Converts a point relative to the centre of the square (x right, y up, mm) to the page.
    pub fn at(&self, x_mm: f64, y_mm: f64) -> PointMm {
        let [c, s] = self.right;
        PointMm::new(
            self.centre.x_mm + c * x_mm - s * y_mm,
            self.centre.y_mm + s * x_mm + c * y_mm,
        )
    }

    /// Returns a rectangle of the square's frame (x right, y up, from its centre) on the page.
    pub fn rectangle(&self, left: f64, bottom: f64, right: f64, top: f64) -> OutlineMm {
        [(left, bottom), (right, bottom), (right, top), (left, top)]
            .map(|(x, y)| self.at(x, y))
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
pub fn stroke(from: PointMm, to: PointMm, width_mm: f64) -> OutlineMm {
    let (dx, dy) = (to.x_mm - from.x_mm, to.y_mm - from.y_mm);
    let length = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let (x, y) = (-dy / length * width_mm / 2.0, dx / length * width_mm / 2.0);
    let beside = |p: PointMm, side: f64| PointMm::new(p.x_mm + side * x, p.y_mm + side * y);
    vec![beside(from, -1.0), beside(to, -1.0), beside(to, 1.0), beside(from, 1.0)]
}

pub fn stroked(outline: &[PointMm], width_mm: f64) -> Vec<OutlineMm> {
    sides(outline).map(|(a, b)| stroke(*a, *b, width_mm)).collect()
}

/// Clips a convex outline to a rectangle, edge by edge (Sutherland & Hodgman 1974); empty if nothing is left.
pub fn clipped(outline: &[PointMm], to: RectMm) -> OutlineMm {
    let rest = cut(outline, |p| p.x_mm - to.left_mm);
    let rest = cut(&rest, |p| to.right_mm - p.x_mm);
    let rest = cut(&rest, |p| p.y_mm - to.bottom_mm);
    cut(&rest, |p| to.top_mm - p.y_mm)
}

fn cut(outline: &[PointMm], inside_by: impl Fn(&PointMm) -> f64) -> OutlineMm {
    let mut kept = Vec::new();
    for (a, b) in sides(outline) {
        let (at_a, at_b) = (inside_by(a), inside_by(b));
        if at_a >= 0.0 {
            kept.push(*a);
        }
        if (at_a < 0.0) != (at_b < 0.0) {
            let share = at_a / (at_a - at_b);
            kept.push(PointMm::new(
                a.x_mm + share * (b.x_mm - a.x_mm),
                a.y_mm + share * (b.y_mm - a.y_mm),
            ));
        }
    }
    kept
}

/// Returns true if two convex outlines share more than a border, by the separating axis theorem.
pub fn overlap(a: &[PointMm], b: &[PointMm]) -> bool {
    /// Tolerance: shared borders are no overlap.
    const TOUCH_MM: f64 = 0.01;
    let edges = |outline: &[PointMm]| -> Vec<(f64, f64)> {
        sides(outline)
            .map(|(p, q)| (q.x_mm - p.x_mm, q.y_mm - p.y_mm))
            .collect()
    };
    let mut axes = edges(a).into_iter().chain(edges(b)).filter(|(x, y)| x.hypot(*y) > 0.0);
    axes.all(|(x, y)| {
        let (nx, ny) = (-y / x.hypot(y), x / x.hypot(y));
        let span = |outline: &[PointMm]| extent(outline.iter().map(|p| p.x_mm * nx + p.y_mm * ny));
        let ((low_a, high_a), (low_b, high_b)) = (span(a), span(b));
        low_a < high_b - TOUCH_MM && low_b < high_a - TOUCH_MM
    })
}
