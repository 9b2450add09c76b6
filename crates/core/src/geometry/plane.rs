//! Points and triangles in a plane.

use std::ops::Range;

use nalgebra::Vector3;

/// A point, or a vector, of a plane.
pub type Point2 = [f64; 2];

pub fn distance(a: Point2, b: Point2) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Returns the point at a share of the way from one point to another: 0 is the first, 1 the second, and other shares go on beyond them.
pub fn between(from: Point2, to: Point2, share: f64) -> Point2 {
    [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
}

/// Returns the point at a distance from another one, along a unit vector.
pub fn offset(p: Point2, along: Point2, by: f64) -> Point2 {
    [0, 1].map(|axis| p[axis] + by * along[axis])
}

/// Returns the share of the way along a segment at which it is nearest to a point: 0 and 1 at its ends.
pub fn nearest_share(p: Point2, [a, b]: [Point2; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    along.clamp(0.0, 1.0)
}

pub fn to_segment(p: Point2, [a, b]: [Point2; 2]) -> f64 {
    let along = nearest_share(p, [a, b]);
    (p[0] - a[0] - along * (b[0] - a[0])).hypot(p[1] - a[1] - along * (b[1] - a[1]))
}

/// Returns the stretches of a range on which something holds.
pub fn stretches(range: Range<usize>, holds: impl Fn(&usize) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for i in range.filter(holds) {
        match found.last_mut() {
            Some(last) if last.end == i => last.end += 1,
            _ => found.push(i..i + 1),
        }
    }
    found
}

/// Returns the cells left of, right of, above and below one of a grid that is counted row by row; `None` beyond its border.
pub fn cells_beside(i: usize, columns: usize, rows: usize) -> [Option<usize>; 4] {
    let (column, row) = (i % columns, i / columns);
    [
        (column > 0).then(|| i - 1),
        (column + 1 < columns).then(|| i + 1),
        (row > 0).then(|| i - columns),
        (row + 1 < rows).then(|| i + columns),
    ]
}

/// Returns the corners of a regular polygon around a point, counter-clockwise from the right.
pub fn circle([x, y]: Point2, radius: f64, corners: u32) -> impl Iterator<Item = Point2> {
    (0..corners).map(move |i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(corners)).sin_cos();
        [x + radius * cos, y + radius * sin]
    })
}

/// Returns the smallest and the largest of some numbers; infinity and its negative for none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    values
        .into_iter()
        .fold(start, |(low, high), v| (low.min(v), high.max(v)))
}

/// Twice the signed area of a triangle: positive where its corners run counter-clockwise with y up.
pub fn doubled_area(a: Point2, b: Point2, c: Point2) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Returns the corners of the convex hull, in order around it; points on its sides are left out. By the monotone chain (Andrew 1979).
pub fn convex_hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2 && doubled_area(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut points.iter().copied());
    let upper = chain(&mut points.iter().rev().copied());
    [lower, upper].concat()
}

/// Returns the axes of a view from outside: to the right, up and towards the viewer, who stands at an azimuth (counter-clockwise from x) and an
/// elevation above the xy plane.
pub fn view_axes(azimuth_deg: f64, elevation_deg: f64) -> [Vector3<f64>; 3] {
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    let (up, level) = elevation_deg.to_radians().sin_cos();
    let towards = Vector3::new(level * cos, level * sin, up);
    let right = Vector3::new(-sin, cos, 0.0);
    [right, towards.cross(&right), towards]
}

/// A triangle with an area, drawn into a grid of unit cells by its barycentric coordinates.
#[derive(Debug, Clone, Copy)]
pub struct PlaneTriangle {
    corners: [Point2; 3],
    doubled_area: f64,
}

impl PlaneTriangle {
    /// A point counts as inside where none of its barycentric coordinates is further below 0, so that neighbours leave no gap.
    pub const EDGE: f64 = 1e-9;

    /// `None` where the corners lie on a line.
    pub fn new(corners: [Point2; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let doubled_area = doubled_area(a, b, c);
        (doubled_area != 0.0).then_some(Self { corners, doubled_area })
    }

    /// Returns the barycentric coordinates of a point; `None` outside the triangle, where one is below −[`Self::EDGE`].
    pub fn barycentric(&self, p: Point2) -> Option<[f64; 3]> {
        let [a, b, c] = self.corners;
        let parts = [doubled_area(b, c, p), doubled_area(c, a, p), doubled_area(a, b, p)];
        let shares = parts.map(|part| part / self.doubled_area);
        shares.iter().all(|share| *share >= -Self::EDGE).then_some(shares)
    }

    /// Returns the unit cells along an axis that the box around the triangle meets, of those in a range.
    pub fn cells(&self, axis: usize, within: Range<i64>) -> Range<i64> {
        cells_between(extent(self.corners.map(|p| p[axis])), within)
    }

    /// Returns the unit cells of a row that the part of the triangle in this row meets, of those in a range: what a sliver crosses, and not the box around it.
    /// None is missing in which [`Self::barycentric`] takes a point for inside.
    pub fn cells_of_row(&self, row: i64, within: Range<i64>) -> Range<i64> {
        // By the tolerance of the edges, a point may lie as far outside as a billionth of the triangle's size.
        const MARGIN: f64 = 1e-3;
        let (bottom, top) = (row as f64 - MARGIN, row as f64 + 1.0 + MARGIN);
        let [a, b, c] = self.corners;
        let sides = [(a, b), (b, c), (c, a)].into_iter();
        let in_row = sides.filter(|(p, q)| p[1].min(q[1]) <= top && p[1].max(q[1]) >= bottom);
        let ends = in_row.flat_map(|(p, q)| {
            [p, q].map(|end| match end[1].clamp(bottom, top) {
                y if y == end[1] => end[0],
                y => p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]),
            })
        });
        let (low, high) = extent(ends);
        cells_between((low - MARGIN, high + MARGIN), within)
    }

    /// Calls with column, row and barycentric coordinates of each cell of a grid in which the triangle covers the place that lies `offset`
    /// right of and above the cell's corner: 0.5 is its centre.
    pub fn draw(&self, size: [usize; 2], offset: f64, mut each: impl FnMut(usize, usize, [f64; 3])) {
        self.draw_within(size.map(|side| 0..side as i64), offset, |column, row, shares| {
            each(column as usize, row as usize, shares);
        });
    }

    /// Draws as [`Self::draw`] does, in a window of the grid: its columns and its rows.
    pub fn draw_within(&self, [columns, rows]: [Range<i64>; 2], offset: f64, mut each: impl FnMut(i64, i64, [f64; 3])) {
        for row in self.cells(1, rows) {
            for column in self.cells_of_row(row, columns.clone()) {
                if let Some(shares) = self.barycentric([column as f64 + offset, row as f64 + offset]) {
                    each(column, row, shares);
                }
            }
        }
    }
}

/// Returns the unit cells that an interval meets, of those in a range.
fn cells_between((low, high): (f64, f64), within: Range<i64>) -> Range<i64> {
    let clamped = |v: f64| v.clamp(within.start as f64, within.end as f64) as i64;
    clamped(low.floor())..clamped(high.floor() + 1.0)
}

/// Sets that are united step by step (union–find). Each is named by its smallest member.
#[derive(Debug, Clone)]
pub struct UnionFind(Vec<usize>);

impl UnionFind {
    /// Creates sets of one member each.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// Returns the smallest member of the set that this one is in.
    pub fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    /// Makes one set of those that two members are in.
    pub fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}
