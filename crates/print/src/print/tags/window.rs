//! A look at the ground through a window: the same drawing on a sheet of the mat, on a place strip, and on the map.
//!
//! *Ground frame*: the ground seen from above, the model's front to the right: x and y of the model frame, millimetres.

use crate::print::shapes::{OutlineMm, clipped};
use crate::print::sheet::{PointMm, RectMm};

/// Which point of the ground lies where on a page, how it is turned, and how much smaller it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundWindow {
    /// On the ground.
    pub centre: PointMm,
    /// Where `centre` lies on the page.
    pub at: PointMm,
    /// Unit vector of the ground that runs to the right on the page.
    pub right: [f64; 2],
    pub scale: f64,
}

impl GroundWindow {
    /// A point of the ground on the page.
    pub fn on_page(&self, p: PointMm) -> PointMm {
        let (x, y) = (p.x_mm - self.centre.x_mm, p.y_mm - self.centre.y_mm);
        let [c, s] = self.right;
        PointMm::new(
            self.at.x_mm + self.scale * (c * x + s * y),
            self.at.y_mm + self.scale * (c * y - s * x),
        )
    }

    /// An outline of the ground on the page.
    pub fn outline(&self, outline: &[PointMm]) -> OutlineMm {
        outline.iter().map(|p| self.on_page(*p)).collect()
    }

    /// What is seen of some outlines inside a rectangle of the page.
    pub fn clipped(&self, outlines: &[OutlineMm], to: RectMm) -> Vec<OutlineMm> {
        let seen = outlines.iter().map(|outline| clipped(&self.outline(outline), to));
        seen.filter(|outline| outline.len() > 2).collect()
    }
}

/// The rectangle around some points.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a PointMm>) -> RectMm {
    let none = RectMm::new(f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY);
    points.into_iter().fold(none, |r, p| {
        RectMm::new(
            r.left_mm.min(p.x_mm),
            r.bottom_mm.min(p.y_mm),
            r.right_mm.max(p.x_mm),
            r.top_mm.max(p.y_mm),
        )
    })
}

/// The rectangle around two.
pub fn union(a: RectMm, b: RectMm) -> RectMm {
    RectMm::new(
        a.left_mm.min(b.left_mm),
        a.bottom_mm.min(b.bottom_mm),
        a.right_mm.max(b.right_mm),
        a.top_mm.max(b.top_mm),
    )
}

/// A rectangle with more on every side.
pub fn grown(r: RectMm, by_mm: f64) -> RectMm {
    RectMm::new(
        r.left_mm - by_mm,
        r.bottom_mm - by_mm,
        r.right_mm + by_mm,
        r.top_mm + by_mm,
    )
}

/// Whether one rectangle lies within another.
pub fn within(inner: RectMm, outer: RectMm) -> bool {
    inner.left_mm >= outer.left_mm
        && inner.right_mm <= outer.right_mm
        && inner.bottom_mm >= outer.bottom_mm
        && inner.top_mm <= outer.top_mm
}
