//! Steep parts of the surface unrolled into the plane: triangles turned about the edges they share until all lie flat, each
//! at its true size.
//!
//! Greedy: a strip starts with the largest triangle left, and takes one neighbour after the other as long as none lies over
//! the strip and the strip fits a sheet. Only triangles of one side are joined, so that the pattern runs on within a strip. What
//! would be too small to handle stays on its panel.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use nalgebra::{Point3, Vector3};

use super::WrapError;
use super::panel::{Face, PRINTED, PaintedSurface, bend_deg};
use super::region::{Contour, Point, Region};
use crate::mesh::doubled_area;
use crate::pattern::world_aligned::Side;

/// Triangles that lie over each other by less than this touch only, mm.
const TOUCH_MM: f64 = 1e-6;
/// Stretch beyond the limit that is rounding.
const ROUNDING: f64 = 1e-9;
/// Edges bent by more than this are drawn as folds.
const FOLD_DEG: f64 = 15.0;
/// Nobody cuts out and glues smaller strips, mm²: 5 × 5 mm.
pub const LEAST_MM2: f64 = 25.0;
/// The place of a smaller triangle's colours would be rounding, mm².
const LEAST_FACE_MM2: f64 = 1e-6;
/// More would take minutes, and thousands of folds help nobody.
const MOST_STEEP: usize = 20_000;

/// A triangle of the surface, flat, at its true size and seen from outside.
#[derive(Debug, Clone, Copy)]
pub struct Unrolled {
    pub face: Face,
    /// The face's corners in the plane of its strip, in the face's order, mm.
    pub corners: [Point; 3],
}

impl Unrolled {
    /// Where a place (u, v) of the side's plane lies in the strip's: the affine map that takes the projected triangle to the
    /// flat one.
    pub fn place(&self, [u, v]: Point) -> Point {
        let [a, b, c] = self.face.corners.map(|p| self.face.side.project(&p));
        let cross = |s: Point, t: Point| s[0] * t[1] - s[1] * t[0];
        let (ab, ac, ap) = (minus(b, a), minus(c, a), minus([u, v], a));
        let whole = cross(ab, ac);
        let (to_b, to_c) = (cross(ap, ac) / whole, cross(ab, ap) / whole);
        let [a, b, c] = self.corners;
        [0, 1].map(|i| a[i] + to_b * (b[i] - a[i]) + to_c * (c[i] - a[i]))
    }
}

/// Connected triangles of one side, unrolled. The first triangle lies as its side does, v up.
#[derive(Debug, Clone)]
pub struct Strip {
    pub side: Side,
    /// It lies a quarter turn clockwise instead, v to the right, as only that fits the sheet.
    pub turned: bool,
    pub faces: Vec<Unrolled>,
    /// Bent edges within the strip.
    pub folds: Vec<[Point; 2]>,
    /// The panels it borders on the model.
    pub panels: Vec<Side>,
    /// The strips it borders, by index.
    pub strips: Vec<usize>,
}

impl Strip {
    /// Everything its triangles cover.
    pub fn region(&self) -> Region {
        Region::union(self.faces.iter().map(|f| f.corners.to_vec()).collect())
    }

    /// Its triangles in the plane of its side, as they would lie on the panel.
    pub fn projected(&self) -> Vec<Contour> {
        let flat = |f: &Unrolled| f.face.corners.map(|p| self.side.project(&p)).to_vec();
        self.faces.iter().map(flat).collect()
    }

    pub fn surface_mm2(&self) -> f64 {
        self.faces.iter().map(|f| f.face.surface_mm2).sum()
    }
}

/// The strips of a surface, and what stays on the panels.
pub struct Unrolling {
    /// Side by side in the order of the panels.
    pub strips: Vec<Strip>,
    pub rest: PaintedSurface,
    pub kept: Kept,
}

/// What is steeper than the limit and stays on its panel all the same.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Kept {
    /// Triangles that no sheet can carry.
    pub too_large: usize,
    /// Connected parts of less than [`LEAST_MM2`], and their area on the surface.
    pub small: usize,
    pub small_mm2: f64,
}

impl Kept {
    fn add_small(&mut self, mm2: f64) {
        self.small += 1;
        self.small_mm2 += mm2;
    }
}

/// Unrolls all printed triangles that the box projection stretches by more than `limit`; no strip is larger than `most_mm`
/// (width, height).
///
/// # Errors
/// More than [`MOST_STEEP`] such triangles.
pub(crate) fn unroll(paint: &PaintedSurface, limit: f64, most_mm: Point) -> Result<Unrolling, WrapError> {
    let mut kept = Kept::default();
    let mut wanted = |face: &Face| {
        let steep = PRINTED.contains(&face.side) && face.stretch > limit + ROUNDING;
        let sliver = face.surface_mm2 < LEAST_FACE_MM2;
        if steep && sliver {
            kept.add_small(face.surface_mm2);
        }
        steep && !sliver
    };
    let mut waiting: Vec<bool> = paint.faces.iter().map(&mut wanted).collect();
    let mut seeds: Vec<usize> = (0..waiting.len()).filter(|i| waiting[*i]).collect();
    if seeds.len() > MOST_STEEP {
        return Err(WrapError::TooManySteep {
            count: seeds.len(),
            most: MOST_STEEP,
        });
    }
    seeds.sort_by(|a, b| paint.faces[*b].surface_mm2.total_cmp(&paint.faces[*a].surface_mm2));
    let edges = paint.edges();
    let mut grown = Vec::new();
    for seed in seeds {
        let growth = waiting[seed].then(|| Growth::from(seed, paint, most_mm)).flatten();
        let Some((faces, strip)) = growth.map(|growth| growth.finished(&edges, &mut waiting)) else {
            continue;
        };
        match strip.surface_mm2() {
            small if small < LEAST_MM2 => kept.add_small(small),
            _ => grown.push((faces, strip)),
        }
    }
    kept.too_large = waiting.iter().filter(|still| **still).count();
    grown.sort_by_key(|(_, strip)| PRINTED.iter().position(|side| *side == strip.side));
    let mut of_face = vec![None; paint.faces.len()];
    for (i, (faces, _)) in grown.iter().enumerate() {
        faces.iter().for_each(|face| of_face[*face] = Some(i));
    }
    let border = |(i, (faces, mut strip)): (usize, (Vec<usize>, Strip))| {
        let beside = faces.iter().flat_map(|f| paint.faces[*f].triangle.edges());
        let beside: BTreeSet<usize> = beside.flat_map(|edge| edges[&edge].iter().copied()).collect();
        let strips: BTreeSet<usize> = beside.iter().filter_map(|f| of_face[*f]).collect();
        strip.strips = strips.into_iter().filter(|other| *other != i).collect();
        let on_panels = |side: &Side| {
            let mut there = beside.iter().filter(|f| of_face[**f].is_none());
            there.any(|f| paint.faces[*f].side == *side)
        };
        strip.panels = PRINTED.into_iter().filter(on_panels).collect();
        strip
    };
    Ok(Unrolling {
        strips: grown.into_iter().enumerate().map(border).collect(),
        rest: paint.without(&of_face.iter().map(Option::is_some).collect::<Vec<_>>()),
        kept,
    })
}

/// A strip that takes its neighbours.
struct Growth<'a> {
    paint: &'a PaintedSurface,
    side: Side,
    turned: bool,
    most_mm: Point,
    /// In the order they were taken, with their flat corners.
    taken: Vec<(usize, [Point; 3])>,
    low: Point,
    high: Point,
    folds: Vec<[Point; 2]>,
}

impl<'a> Growth<'a> {
    /// `None` if the first triangle is larger than a sheet.
    fn from(seed: usize, paint: &'a PaintedSurface, most_mm: Point) -> Option<Self> {
        let face = &paint.faces[seed];
        let mut growth = Self {
            paint,
            side: face.side,
            turned: false,
            most_mm,
            taken: Vec::new(),
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            folds: Vec::new(),
        };
        let upright = upright(face);
        if growth.take(seed, upright) {
            return Some(growth);
        }
        growth.turned = true;
        growth.take(seed, upright.map(|[x, y]| [y, -x])).then_some(growth)
    }

    /// Takes a triangle where it is free and on the sheet.
    fn take(&mut self, face: usize, corners: [Point; 3]) -> bool {
        let low = [0, 1].map(|i| corners.iter().fold(self.low[i], |low, p| low.min(p[i])));
        let high = [0, 1].map(|i| corners.iter().fold(self.high[i], |high, p| high.max(p[i])));
        let fits = (0..2).all(|i| high[i] - low[i] <= self.most_mm[i]);
        if !fits || self.taken.iter().any(|(_, other)| overlap(&corners, other)) {
            return false;
        }
        (self.low, self.high) = (low, high);
        self.taken.push((face, corners));
        true
    }

    /// The strip with all neighbours that it could take of those that wait.
    fn finished(mut self, edges: &BTreeMap<[usize; 2], Vec<usize>>, waiting: &mut [bool]) -> (Vec<usize>, Strip) {
        let mut open: VecDeque<usize> = [0].into();
        waiting[self.taken[0].0] = false;
        while let Some(at) = open.pop_front() {
            let (face, corners) = self.taken[at];
            for k in 0..3 {
                let Some((next, flat)) = self.over_edge(face, corners, k, edges) else {
                    continue;
                };
                if waiting[next] && self.take(next, flat) {
                    waiting[next] = false;
                    open.push_back(self.taken.len() - 1);
                    if bend_deg(&self.paint.faces[face], &self.paint.faces[next]) > FOLD_DEG {
                        self.folds.push([corners[k], corners[(k + 1) % 3]]);
                    }
                }
            }
        }
        let unrolled = |(face, corners): &(usize, [Point; 3])| Unrolled {
            face: self.paint.faces[*face],
            corners: *corners,
        };
        let strip = Strip {
            side: self.side,
            turned: self.turned,
            faces: self.taken.iter().map(unrolled).collect(),
            folds: self.folds,
            panels: Vec::new(),
            strips: Vec::new(),
        };
        (self.taken.into_iter().map(|(face, _)| face).collect(), strip)
    }

    /// The one other face of this side at the edge from corner `k`, turned about it into the plane. `None` also where the two
    /// do not agree on what is outside.
    fn over_edge(
        &self,
        face: usize,
        flat: [Point; 3],
        k: usize,
        edges: &BTreeMap<[usize; 2], Vec<usize>>,
    ) -> Option<(usize, [Point; 3])> {
        let corners = self.paint.faces[face].triangle.corners;
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let meeting = edges.get(&[from.min(to), from.max(to)])?;
        let next = match meeting[..] {
            [a, b] if a == face => b,
            [a, b] if b == face => a,
            _ => return None,
        };
        let other = &self.paint.faces[next];
        // Seen from the neighbour the edge runs the other way.
        let first = (0..3).find(|i| {
            let ends = [other.triangle.corners[*i], other.triangle.corners[(*i + 1) % 3]];
            ends == [to, from] && other.side == self.side
        })?;
        let at = |i: usize| other.corners[(first + i) % 3];
        let (p, q) = (flat[(k + 1) % 3], flat[k]);
        let third = turned(at(0), at(1), at(2), p, q);
        let mut corners = [p; 3];
        for (i, place) in [p, q, third].into_iter().enumerate() {
            corners[(first + i) % 3] = place;
        }
        Some((next, corners))
    }
}

/// A face in its own plane: u of its side to the right as far as the slope allows, the first corner at (0, 0).
fn upright(face: &Face) -> [Point; 3] {
    let normal = doubled_area(&face.corners).normalize();
    let [u, _] = face.side.axes();
    let right = (u - u.dot(&normal) * normal).normalize();
    let up = normal.cross(&right);
    let flat = |v: Vector3<f64>| [right.dot(&v), up.dot(&v)];
    face.corners.map(|p| flat(p - face.corners[0]))
}

/// Where `c` lies in the plane to the left of p → q, when `a` lies at p and `b` at q.
fn turned(a: Point3<f64>, b: Point3<f64>, c: Point3<f64>, p: Point, q: Point) -> Point {
    let (edge, to_c) = (b - a, c - a);
    let squared = edge.norm_squared();
    let along = to_c.dot(&edge) / squared;
    let aside = edge.cross(&to_c).norm() / squared;
    let [dx, dy] = minus(q, p);
    [p[0] + along * dx - aside * dy, p[1] + along * dy + aside * dx]
}

/// Whether two triangles, both counter-clockwise, share more than their borders: no edge of either separates them.
fn overlap(a: &[Point; 3], b: &[Point; 3]) -> bool {
    !separates(a, b) && !separates(b, a)
}

fn separates(a: &[Point; 3], b: &[Point; 3]) -> bool {
    (0..3).any(|k| {
        let (from, to) = (a[k], a[(k + 1) % 3]);
        let [dx, dy] = minus(to, from);
        let length = dx.hypot(dy);
        // How far a place is to the right of the edge: outside.
        let outside = |p: &Point| (dy * (p[0] - from[0]) - dx * (p[1] - from[1])) / length;
        b.iter().all(|p| outside(p) >= -TOUCH_MM)
    })
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}
