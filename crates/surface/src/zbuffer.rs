//! Z-buffer: which of many triangles is nearest at each pixel of an image, and how far away it is.

use std::ops::Range;

use scaleproof_core::geometry::{PlaneTriangle, Point2};

/// Nearest surface at a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest<T> {
    /// Distance from the viewer, in any unit that grows with it.
    pub depth: f64,
    /// Value that the triangle was drawn with.
    pub item: T,
}

/// Nearest surface at each pixel of a window: an image, or an area that reaches beyond it.
#[derive(Debug, Clone)]
pub struct ZBuffer<T> {
    columns: Range<i64>,
    rows: Range<i64>,
    /// Coordinate of pixel 0's centre along both axes, px: 0, or 0.5 where pixels are counted by their corners.
    centre: f64,
    pixels: Vec<Option<Nearest<T>>>,
}

impl<T: Copy> ZBuffer<T> {
    /// Creates a window in which nothing is drawn.
    pub fn new(columns: Range<i64>, rows: Range<i64>, centre: f64) -> Self {
        let length = |side: &Range<i64>| usize::try_from(side.end - side.start).unwrap_or(0);
        Self {
            pixels: vec![None; length(&columns) * length(&rows)],
            columns,
            rows,
            centre,
        }
    }

    /// Draws a triangle at the pixels whose centre it covers and where nothing drawn before is as near. `depth` and `item` take the barycentric
    /// coordinates there.
    pub fn draw(&mut self, corners: [Point2; 3], depth: impl Fn([f64; 3]) -> f64, item: impl Fn([f64; 3]) -> T) {
        let Some(triangle) = PlaneTriangle::new(corners) else {
            return;
        };
        let window = [self.columns.clone(), self.rows.clone()];
        triangle.draw_within(window, self.centre, |column, row, shares| {
            let depth = depth(shares);
            if let Some(at) = self.index(column, row)
                && self.pixels[at].is_none_or(|nearest| depth < nearest.depth)
            {
                let item = item(shares);
                self.pixels[at] = Some(Nearest { depth, item });
            }
        });
    }

    /// Returns what is nearest at a pixel; `None` where nothing is drawn, and beyond the window.
    pub fn at(&self, column: i64, row: i64) -> Option<Nearest<T>> {
        self.pixels[self.index(column, row)?]
    }

    /// Returns the pixels of the window, row by row.
    pub fn pixels(&self) -> &[Option<Nearest<T>>] {
        &self.pixels
    }

    fn index(&self, column: i64, row: i64) -> Option<usize> {
        let is_inside = self.columns.contains(&column) && self.rows.contains(&row);
        let width = self.columns.end - self.columns.start;
        is_inside.then_some(((row - self.rows.start) * width + column - self.columns.start) as usize)
    }
}
