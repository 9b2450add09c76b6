//! Spatial index of items in a plane.

use smallvec::SmallVec;

use super::wrap::corners;
use scaleproof_core::geometry::Point2;

/// Returns the corners of the bounding box of points, grown on all sides: lowest, highest.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a Point2>, grown_mm: f64) -> (Point2, Point2) {
    let (low, high) = corners(points);
    (low.map(|mm| mm - grown_mm), high.map(|mm| mm + grown_mm))
}

/// Items by position: a grid of buckets.
pub struct Buckets {
    low: Point2,
    step: Point2,
    columns: usize,
    rows: usize,
    lists: Vec<Vec<u32>>,
}

impl Buckets {
    pub fn new(low: Point2, high: Point2, boxes: impl ExactSizeIterator<Item = (Point2, Point2)>) -> Self {
        const MOST: f64 = 400.0;
        let size = [0, 1].map(|axis| (high[axis] - low[axis]).max(1e-6));
        // About one item per bucket, with square buckets.
        let step = (size[0] * size[1] / boxes.len().max(1) as f64)
            .sqrt()
            .max(size[0].max(size[1]) / MOST);
        let count = |axis: usize| ((size[axis] / step).ceil() as usize).max(1);
        let mut buckets = Self {
            low,
            step: [step; 2],
            columns: count(0),
            rows: count(1),
            lists: Vec::new(),
        };
        buckets.lists = vec![Vec::new(); buckets.columns * buckets.rows];
        for (i, corners) in boxes.enumerate() {
            for cell in buckets.cells(corners) {
                buckets.lists[cell].push(i as u32);
            }
        }
        buckets
    }

    fn index(&self, p: Point2, axis: usize) -> usize {
        let count = if axis == 0 { self.columns } else { self.rows };
        (((p[axis] - self.low[axis]) / self.step[axis]).max(0.0) as usize).min(count - 1)
    }

    /// Returns the indices of the buckets that a box touches, row by row.
    fn cells(&self, (from, to): (Point2, Point2)) -> impl Iterator<Item = usize> + use<> {
        let width = self.columns;
        let (first, last) = (self.index(from, 0), self.index(to, 0));
        let rows = self.index(from, 1)..=self.index(to, 1);
        rows.flat_map(move |row| (first..=last).map(move |column| row * width + column))
    }

    /// Returns the indices of all items that may touch a box, ascending.
    pub fn over(&self, corners: (Point2, Point2)) -> SmallVec<[u32; 16]> {
        let all = self.cells(corners).flat_map(|i| &self.lists[i]);
        let mut found: SmallVec<[u32; 16]> = all.copied().collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Returns the indices of the items near a point; `None` outside of all buckets.
    pub fn at(&self, p: Point2) -> Option<&[u32]> {
        let high = |axis: usize, count: usize| self.low[axis] + self.step[axis] * count as f64;
        let outside = |axis: usize, count: usize| p[axis] < self.low[axis] || p[axis] > high(axis, count);
        if outside(0, self.columns) || outside(1, self.rows) {
            return None;
        }
        let list = self.lists.get(self.index(p, 1) * self.columns + self.index(p, 0));
        list.map(Vec::as_slice)
    }
}
