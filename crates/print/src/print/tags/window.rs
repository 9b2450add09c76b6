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
    /// A window with the model's front to the right.
    pub fn level(centre: (f64, f64), at: (f64, f64), scale: f64) -> Self {
        Self {
            centre: centre.into(),
            at: at.into(),
            right: [1.0, 0.0],
            scale,
        }
    }

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
