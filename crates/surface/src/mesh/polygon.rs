//! A face of any outline, cut into triangles: a fan where that fits, else ears (Meisters, 1975). The outline may touch itself, as that of a hole
//! does which a bridge joins to the border; it may not cross itself.

use std::collections::VecDeque;

use nalgebra::{Point3, Vector3};

use scaleproof_core::geometry::doubled_area;

type Point = [f64; 2];

/// Largest number of corners: cutting ears takes the square of it.
const MAX_CORNERS: usize = 10_000;
/// Areas that count as nothing, as shares of the face: the rounding of this program, then that of a file of 32-bit numbers.
const NOTHING: [f64; 2] = [1e-12, 1e-7];

/// Returns the triangles of a face as indices of its corners, two fewer than it has corners and turning the way it turns.
///
/// # Errors
/// An outline that crosses itself; as a clause.
pub(super) fn triangles(corners: &[Point3<f64>]) -> Result<Vec<[usize; 3]>, String> {
    let fan = || (2..corners.len()).map(|i| [0, i - 1, i]).collect();
    if corners.len() <= 3 {
        return Ok(fan());
    }
    // Corners on one line have no area, however they are cut.
    let Some(normal) = normal(corners) else {
        return Ok(fan());
    };
    let views = [along_axis(corners, &normal), along(corners, &normal)];
    if views.iter().any(|flat| is_star(flat, NOTHING[0] * scale(flat))) {
        return Ok(fan());
    }
    if corners.len() > MAX_CORNERS {
        return Err(format!("has {} corners, more than {MAX_CORNERS}", corners.len()));
    }
    let cut = |flat: &Vec<Point>| {
        let areas = NOTHING.map(|share| share * scale(flat));
        areas.into_iter().find_map(|nothing| Outline::new(flat, nothing).cut())
    };
    views.iter().find_map(cut).ok_or_else(|| "crosses itself".to_owned())
}

/// Returns twice the face's area as a vector (Newell); `None` for corners on one line.
fn normal(corners: &[Point3<f64>]) -> Option<Vector3<f64>> {
    let first = corners[0];
    let crosses = corners
        .windows(2)
        .map(|pair| (pair[0] - first).cross(&(pair[1] - first)));
    let total: Vector3<f64> = crosses.clone().sum();
    let widest = crosses
        .clone()
        .max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()))?;
    let all: f64 = crosses.map(|cross| cross.norm()).sum();
    // Halves that cancel, as in a bow tie, leave no direction.
    let normal = if total.norm() > NOTHING[1] * all { total } else { widest };
    (normal.norm() > 0.0).then_some(normal)
}

/// Returns the corners seen along the axis that the normal is nearest to, counter-clockwise: numbers stay as they are, so that corners which touch in
/// the file touch here.
fn along_axis(corners: &[Point3<f64>], normal: &Vector3<f64>) -> Vec<Point> {
    let axis = normal.iamax();
    let [mut across, mut up] = [(axis + 1) % 3, (axis + 2) % 3];
    if normal[axis] < 0.0 {
        (across, up) = (up, across);
    }
    corners.iter().map(|p| [p[across], p[up]]).collect()
}

/// Returns the corners seen along the normal, counter-clockwise: a face that is not plane may cross itself when it is seen from elsewhere.
fn along(corners: &[Point3<f64>], normal: &Vector3<f64>) -> Vec<Point> {
    let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let up = normal.normalize().cross(&across);
    let place = |p: &Point3<f64>| [across, up].map(|axis| axis.dot(&(p - corners[0])));
    corners.iter().map(place).collect()
}

/// Returns the area that rounding is measured by: the extent times the largest coordinate.
fn scale(flat: &[Point]) -> f64 {
    let values = || flat.iter().flatten();
    let most = values().fold(0.0, |most: f64, c| most.max(c.abs()));
    let extent = flat
        .iter()
        .flat_map(|p| [0, 1].map(|axis| (p[axis] - flat[0][axis]).abs()));
    extent.fold(0.0, f64::max) * most
}

/// Returns true if all of the face is seen from its first corner, so that a fan from there covers it once.
fn is_star(flat: &[Point], nothing: f64) -> bool {
    let first = flat[0];
    let mut turned = 0.0;
    flat[1..].windows(2).all(|pair| {
        let area = doubled_area(first, pair[0], pair[1]);
        let [a, b] = [pair[0], pair[1]].map(|p| [p[0] - first[0], p[1] - first[1]]);
        turned += area.atan2(a[0] * b[0] + a[1] * b[1]);
        area >= -nothing && turned < std::f64::consts::TAU - 1e-9
    })
}

/// Rest of a face while its ears are cut.
struct Outline<'a> {
    flat: &'a [Point],
    /// Area that counts as none.
    nothing: f64,
    next: Vec<usize>,
    previous: Vec<usize>,
    left: usize,
    triangles: Vec<[usize; 3]>,
}

impl<'a> Outline<'a> {
    fn new(flat: &'a [Point], nothing: f64) -> Self {
        let count = flat.len();
        Self {
            flat,
            nothing,
            next: (1..=count).map(|i| i % count).collect(),
            previous: (0..count).map(|i| (i + count - 1) % count).collect(),
            left: count,
            triangles: Vec::with_capacity(count - 2),
        }
    }

    /// Cuts all ears. `None` where no ear is left, which is so where the outline crosses itself: of the two triangles beside a crossing, the one that
    /// would be cut first has the other's border inside.
    fn cut(mut self) -> Option<Vec<[usize; 3]>> {
        // A corner that is no ear becomes one only when one of its neighbours is cut.
        let mut open: VecDeque<usize> = (0..self.flat.len()).collect();
        let mut last = 0;
        while self.left > 2 {
            let corner = match open.pop_front() {
                Some(corner) if !self.is_left(corner) || !self.is_ear(corner) => continue,
                Some(corner) => corner,
                // Corners on a line, and the ends of bridges, when nothing else is left.
                None => self
                    .around(last)
                    .find(|corner| self.area(*corner).abs() <= self.nothing)?,
            };
            let (before, after) = (self.previous[corner], self.next[corner]);
            self.triangles.push([before, corner, after]);
            (self.next[before], self.previous[after]) = (after, before);
            self.next[corner] = usize::MAX;
            self.left -= 1;
            last = after;
            open.extend([before, after]);
        }
        Some(self.triangles)
    }

    fn is_left(&self, corner: usize) -> bool {
        self.next[corner] != usize::MAX
    }

    fn area(&self, corner: usize) -> f64 {
        let at = |i: usize| self.flat[i];
        doubled_area(at(self.previous[corner]), at(corner), at(self.next[corner]))
    }

    /// Returns the corners that are left, from one of them on.
    fn around(&self, first: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(first), |corner| Some(self.next[*corner])).take(self.left)
    }

    /// Returns true if the corner and its neighbours are a triangle of the face: it turns the face's way, and no edge of the outline passes inside.
    fn is_ear(&self, corner: usize) -> bool {
        let (before, after) = (self.previous[corner], self.next[corner]);
        let triangle = [before, corner, after].map(|i| self.flat[i]);
        let others = || self.around(after).take(self.left - 2);
        self.area(corner) > self.nothing
            && !others().any(|i| self.passes_inside(&triangle, [self.flat[i], self.flat[self.next[i]]]))
    }

    /// Returns true if some of an edge is strictly inside a triangle, which turns counter-clockwise.
    fn passes_inside(&self, triangle: &[Point; 3], [from, to]: [Point; 2]) -> bool {
        let is_beside = |axis: usize| {
            let [a, b, c] = triangle.map(|p| p[axis]);
            from[axis].max(to[axis]) <= a.min(b).min(c) || from[axis].min(to[axis]) >= a.max(b).max(c)
        };
        if is_beside(0) || is_beside(1) {
            return false;
        }
        // The part of the edge, from 0 to 1, that is left of every side.
        let (mut enters, mut leaves): (f64, f64) = (0.0, 1.0);
        for side in 0..3 {
            let (a, b) = (triangle[side], triangle[(side + 1) % 3]);
            let [start, end] = [from, to].map(|p| doubled_area(a, b, p) - self.nothing);
            match (start > 0.0, end > 0.0) {
                (false, false) => return false,
                (true, true) => {}
                (false, true) => enters = enters.max(start / (start - end)),
                (true, false) => leaves = leaves.min(start / (start - end)),
            }
        }
        enters < leaves
    }
}
