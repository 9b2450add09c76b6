//! Paint as faces: its corners welded, its large triangles subdivided.

use std::collections::{BTreeMap, BTreeSet, BinaryHeap, HashMap};

use nalgebra::Point3;

use super::{LeftOut, LeftOutReason, MAX_TRIANGLES, UnwrapError};
use scaleproof_surface::mesh::{Mesh, doubled_area, edges};

/// Distance, as a share of the mesh's longest side, below which corners are welded.
const WELD: f64 = 1e-6;
/// Ratio of height to longest side below which a triangle is degenerate.
const LEAST_HEIGHT: f64 = 1e-6;
/// Maximum length of an edge, as a share of the paper's shorter side, so that pieces can be cut anywhere.
const EDGE_OF_PAPER: f64 = 0.25;

/// Barycentric coordinates of the corners of a whole triangle.
pub const WHOLE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// For each edge of each face the face at its other side, and the index of that face's edge.
pub(super) type Neighbours = Vec<[Option<(usize, usize)>; 3]>;

/// Triangle of the paint, or a part of one.
#[derive(Debug, Clone)]
pub(super) struct Face {
    pub triangle: usize,
    pub weights: [[f64; 3]; 3],
    pub corners: [usize; 3],
}

#[derive(Debug)]
pub(super) struct Surface {
    pub points: Vec<Point3<f64>>,
    pub faces: Vec<Face>,
    lines: Vec<usize>,
}

impl Surface {
    pub(super) fn new(mesh: &Mesh, materials: &[usize], fits_mm: Option<[f64; 2]>) -> Result<Self, UnwrapError> {
        let paint = mesh.painted(materials);
        let count = paint.clone().count();
        if count > MAX_TRIANGLES {
            return Err(UnwrapError::TooManyTriangles { count });
        }
        let (points, place) = welded(mesh);
        let (mut faces, mut lines) = (Vec::new(), Vec::new());
        for triangle in paint {
            let corners = mesh.triangles()[triangle].corners.map(|c| place[c]);
            if is_line(&corners.map(|c| points[c])) {
                lines.push(triangle);
            } else {
                faces.push(Face {
                    triangle,
                    weights: WHOLE,
                    corners,
                });
            }
        }
        if faces.is_empty() {
            return Err(UnwrapError::NoPaint);
        }
        let mut surface = Self { points, faces, lines };
        if let Some(size) = fits_mm {
            surface.subdivide(EDGE_OF_PAPER * size[0].min(size[1]), size)?;
        }
        Ok(surface)
    }

    /// Keeps only these faces.
    pub(super) fn keep(&mut self, is_kept: &[bool]) {
        let mut is_kept = is_kept.iter();
        self.faces.retain(|_| is_kept.next() == Some(&true));
    }

    pub(super) fn corners(&self, face: usize) -> [Point3<f64>; 3] {
        self.faces[face].corners.map(|c| self.points[c])
    }

    pub(super) fn area(&self, face: usize) -> f64 {
        0.5 * doubled_area(&self.corners(face)).norm()
    }

    /// Returns the neighbours at edges that exactly two faces share, if `is_allowed` for the two (face and edge of each).
    pub(super) fn neighbours(&self, is_allowed: impl Fn([usize; 2], [usize; 2]) -> bool) -> Neighbours {
        let mut at_edge: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
        for (f, face) in self.faces.iter().enumerate() {
            for (side, edge) in edges(face.corners).into_iter().enumerate() {
                at_edge.entry(edge).or_default().push([f, side]);
            }
        }
        let mut beside = vec![[None; 3]; self.faces.len()];
        for sides in at_edge.values() {
            if let [a, b] = sides[..]
                && is_allowed(a, b)
            {
                beside[a[0]][a[1]] = Some(b.into());
                beside[b[0]][b[1]] = Some(a.into());
            }
        }
        beside
    }

    /// Halves the longest edge, with every face at it, until none is longer (Rivara 1984).
    fn subdivide(&mut self, longest_mm: f64, size_mm: [f64; 2]) -> Result<(), UnwrapError> {
        let mut at_edge: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        let mut queue = BinaryHeap::new();
        for face in 0..self.faces.len() {
            for edge in edges(self.faces[face].corners) {
                at_edge.entry(edge).or_default().push(face);
                self.push_if_long(edge, longest_mm, &mut queue);
            }
        }
        while let Some((_, edge)) = queue.pop() {
            let Some(split) = at_edge.remove(&edge) else { continue };
            if self.faces.len() + split.len() > MAX_TRIANGLES {
                return Err(UnwrapError::BadSize { size_mm });
            }
            let middle = self.points.len();
            self.points
                .push(nalgebra::center(&self.points[edge[0]], &self.points[edge[1]]));
            for face in split {
                let new = self.faces.len();
                for old in edges(self.faces[face].corners) {
                    at_edge.entry(old).or_default().retain(|f| *f != face);
                }
                self.halve(face, edge, middle);
                for part in [face, new] {
                    for edge in edges(self.faces[part].corners) {
                        at_edge.entry(edge).or_default().push(part);
                        self.push_if_long(edge, longest_mm, &mut queue);
                    }
                }
            }
        }
        Ok(())
    }

    fn push_if_long(&self, edge: [usize; 2], longest_mm: f64, queue: &mut BinaryHeap<(u64, [usize; 2])>) {
        let length = (self.points[edge[0]] - self.points[edge[1]]).norm();
        if length > longest_mm {
            // The bits of positive numbers sort like the numbers.
            queue.push((length.to_bits(), edge));
        }
    }

    /// Halves a face: it keeps the half at the edge's first corner in its own order; the other half is appended.
    fn halve(&mut self, face: usize, edge: [usize; 2], middle: usize) {
        let old = &self.faces[face];
        let (mut first, mut second) = (old.clone(), old.clone());
        let is_edge = |i: &usize| {
            let ends = [old.corners[*i], old.corners[(i + 1) % 3]];
            ends == edge || ends == [edge[1], edge[0]]
        };
        let Some(from) = (0..3).find(is_edge) else { return };
        let to = (from + 1) % 3;
        let weights = std::array::from_fn(|i| 0.5 * (old.weights[from][i] + old.weights[to][i]));
        (first.corners[to], first.weights[to]) = (middle, weights);
        (second.corners[from], second.weights[from]) = (middle, weights);
        self.faces[face] = first;
        self.faces.push(second);
    }

    /// Returns the triangles of the mesh that these faces are parts of. Degenerate triangles, which have no faces, are included for their reason.
    pub(super) fn left_out(&self, faces: &[usize], reason: LeftOutReason) -> Option<LeftOut> {
        let lines = (reason == LeftOutReason::NoArea).then_some(&self.lines);
        let parts = faces.iter().map(|f| self.faces[*f].triangle);
        let triangles: BTreeSet<usize> = parts.chain(lines.into_iter().flatten().copied()).collect();
        (!triangles.is_empty()).then(|| LeftOut {
            triangles: triangles.into_iter().collect(),
            surface_mm2: faces.iter().map(|f| self.area(*f)).sum(),
            reason,
        })
    }
}

fn is_line(corners: &[Point3<f64>; 3]) -> bool {
    let longest = (0..3)
        .map(|i| (corners[i] - corners[(i + 1) % 3]).norm())
        .fold(0.0, f64::max);
    doubled_area(corners).norm() <= LEAST_HEIGHT * longest * longest
}

/// Welds close corners; returns the points, and the index of each corner of the mesh among them.
fn welded(mesh: &Mesh) -> (Vec<Point3<f64>>, Vec<usize>) {
    let (low, high) = mesh.bounds_mm();
    let tolerance = WELD * (high - low).amax();
    if tolerance <= 0.0 {
        return (mesh.points().to_vec(), (0..mesh.points().len()).collect());
    }
    let cell = |p: &Point3<f64>| [0, 1, 2].map(|i| ((p[i] - low[i]) / tolerance).floor() as i64);
    let mut at: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let (mut points, mut place): (Vec<Point3<f64>>, _) = (Vec::new(), Vec::new());
    for p in mesh.points() {
        let [x, y, z] = cell(p);
        let around = (0..27).filter_map(|i| at.get(&[x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1]));
        let near = around
            .flatten()
            .find(|q| (points[**q] - p).norm() <= tolerance)
            .copied();
        place.push(near.unwrap_or_else(|| {
            points.push(*p);
            at.entry([x, y, z]).or_default().push(points.len() - 1);
            points.len() - 1
        }));
    }
    (points, place)
}
