//! Convex polygons of the plane: clipping by lines, and measuring.

use std::ops::RangeInclusive;

use smallvec::SmallVec;

use scaleproof_core::geometry::clip::clip;
use scaleproof_core::geometry::{Point2, doubled_area, extent};

/// Corners of a convex polygon: a pixel cut by a triangle and by the borders of a cell rarely has more than eight.
pub type Polygon = SmallVec<[Point2; 8]>;

/// Affine function on the plane, such as the image column on a flat triangle.
#[derive(Debug, Clone, Copy)]
pub struct Affine {
    origin: Point2,
    value: f64,
    slope: [f64; 2],
    /// Lowest and highest value on the triangle.
    range: [f64; 2],
}

impl Affine {
    /// Returns the function with these values at a triangle's corners; `None` for a triangle without area, and for values out of range.
    pub fn through([a, b, c]: &[Point2; 3], values: [f64; 3]) -> Option<Self> {
        let doubled = doubled_area(*a, *b, *c);
        let [along_b, along_c] = [values[1] - values[0], values[2] - values[0]];
        let slope = [
            (along_b * (c[1] - a[1]) - along_c * (b[1] - a[1])) / doubled,
            (along_c * (b[0] - a[0]) - along_b * (c[0] - a[0])) / doubled,
        ];
        let (low, high) = extent(values);
        let is_good = slope.iter().chain(&[low, high]).all(|number| number.abs() < 1e12);
        is_good.then_some(Self {
            origin: *a,
            value: values[0],
            slope,
            range: [low, high],
        })
    }

    fn at(&self, p: &Point2) -> f64 {
        self.value + self.slope[0] * (p[0] - self.origin[0]) + self.slope[1] * (p[1] - self.origin[1])
    }

    /// Returns the range of the function's values on a polygon in the triangle, rounded down to integers.
    pub fn cells(&self, polygon: &[Point2]) -> RangeInclusive<i64> {
        let [low, high] = self.range;
        let cell = |value: f64| value.clamp(low, high).floor() as i64;
        let (lowest, highest) = extent(polygon.iter().map(|p| self.at(p)));
        cell(lowest)..=cell(highest)
    }
}

/// Slices a polygon by the integer part of the value: calls `found` with each integer and the part where the value lies between it and the next.
pub fn each_slice(
    polygon: &[Point2],
    value: &Affine,
    cells: RangeInclusive<i64>,
    mut found: impl FnMut(i64, &[Point2]),
) {
    let (first, last) = cells.into_inner();
    if first == last {
        return found(first, polygon);
    }
    let mut rest = Polygon::from_slice(polygon);
    let (mut part, mut beyond) = (Polygon::new(), Polygon::new());
    for cell in first..last {
        let above = |p: &Point2| value.at(p) - (cell + 1) as f64;
        cut(&rest, above, &mut beyond);
        if beyond.is_empty() {
            found(cell, &rest);
            rest.clear();
        } else {
            cut(&rest, |p| (cell + 1) as f64 - value.at(p), &mut part);
            found(cell, &part);
            std::mem::swap(&mut rest, &mut beyond);
        }
    }
    found(last, &rest);
}

/// Clips a polygon to a triangle.
pub fn within(polygon: &[Point2], [a, b, c]: &[Point2; 3]) -> Polygon {
    let turn = doubled_area(*a, *b, *c).signum();
    let (mut part, mut less) = (Polygon::from_slice(polygon), Polygon::new());
    for (from, to) in [(a, b), (b, c), (c, a)] {
        cut(&part, |p| turn * doubled_area(*from, *to, *p), &mut less);
        std::mem::swap(&mut part, &mut less);
    }
    part
}

/// Clips a polygon to the half-plane where an affine function is not negative.
fn cut(polygon: &[Point2], value: impl Fn(&Point2) -> f64, part: &mut Polygon) {
    part.clear();
    clip(polygon, value, |corner| part.push(corner));
}

pub fn area(polygon: &[Point2]) -> f64 {
    let Some((first, rest)) = polygon.split_first() else {
        return 0.0;
    };
    let fan = rest.windows(2).map(|pair| doubled_area(*first, pair[0], pair[1]));
    0.5 * fan.sum::<f64>().abs()
}
