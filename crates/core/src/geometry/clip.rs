//! Clipping of convex polygons to half-planes.

use super::plane::{Point2, between};

/// Corner of a polygon: a point of the plane, perhaps with values that vary linearly along a side.
pub trait Corner: Copy {
    /// Returns the corner at a share of the way along a side: 0 is its start, 1 its end.
    fn along(self, end: Self, share: f64) -> Self;
}

impl Corner for Point2 {
    fn along(self, end: Self, share: f64) -> Self {
        between(self, end, share)
    }
}

/// Clips a convex polygon to the half-plane where a linear function of its corners is not negative (Sutherland & Hodgman 1974), and calls
/// `keep` with the corners of what is left, in order.
pub fn clip<T: Corner>(polygon: &[T], inside_by: impl Fn(&T) -> f64, mut keep: impl FnMut(T)) {
    let Some(first) = polygon.first() else { return };
    let at_first = inside_by(first);
    let mut here = at_first;
    for (i, start) in polygon.iter().enumerate() {
        let (end, next) = match polygon.get(i + 1) {
            Some(end) => (end, inside_by(end)),
            None => (first, at_first),
        };
        if here >= 0.0 {
            keep(*start);
        }
        if (here < 0.0) != (next < 0.0) {
            keep(start.along(*end, here / (here - next)));
        }
        here = next;
    }
}

/// Clips a convex polygon to a half-plane, as [`clip`] does; empty if nothing is left.
pub fn clipped<T: Corner>(polygon: &[T], inside_by: impl Fn(&T) -> f64) -> Vec<T> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    clip(polygon, inside_by, |corner| kept.push(corner));
    kept
}
