//! Pieces, glued edges, and the test of a set of faces as a piece: laid flat and checked against every bound.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::UnwrapRequest;
use super::outline::{Side, is_crossing, rectangle};
use super::patch::{Energy, Flat, Patch};
use super::surface::{Neighbours, Surface};
use scaleproof_core::geometry::UnionFind;
use scaleproof_surface::mesh::doubled_area;

/// Maximum number of unfolding steps, and the relative gain of energy below which they end.
const UNFOLD: (usize, f64) = (10, 0.02);
/// Maximum number of steps after unfolding, and the relative gain of energy below which they end: in a trial, and for the final result.
const TRIAL: (usize, f64) = (30, 5e-3);
const FINAL: (usize, f64) = (60, 1e-3);
/// Ratio of the mean stretch's excess to its bound after unfolding above which a piece is given up.
const HOPELESS: f64 = 4.0;
/// Maximum stretch of a face.
const WORST: f64 = 2.5;
/// Maximum number of faces of a piece; larger pieces take seconds for each trial.
const MOST_FACES: usize = 10_000;

#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub faces: Vec<usize>,
    pub flat: Vec<[Vector2<f64>; 3]>,
    pub stretch: Vec<f64>,
    pub sums: Sums,
    pub outline_mm: f64,
    /// Rotation to its smallest bounding rectangle.
    turn: f64,
}

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sums {
    pub area: f64,
    /// Integral of the stretch's excess over 1, over the area.
    pub excess: f64,
    /// Area stretched beyond the requested 99th percentile.
    pub above: f64,
    /// Area of the smallest rectangle around it.
    pub paper: f64,
}

impl std::ops::Add for Sums {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            excess: self.excess + other.excess,
            above: self.above + other.above,
            paper: self.paper + other.paper,
        }
    }
}

/// Edge of a face: face and side.
pub(super) type Edge = (usize, usize);

#[derive(Clone)]
pub(super) struct Assembly<'a> {
    pub surface: &'a Surface,
    /// The face across each edge of each face, and the index of that face's edge.
    pub across: &'a Neighbours,
    pub request: &'a UnwrapRequest,
    /// Pieces; `None` for a piece that was glued to another, and became a new one.
    pub pieces: Vec<Option<Piece>>,
    pub piece_of: Vec<Option<usize>>,
    pub glued: Vec<[bool; 3]>,
    /// Bound on the excess of a piece's mean stretch over 1.
    pub worst_excess: f64,
    /// Index of each face among those currently laid flat.
    local: Vec<usize>,
}

impl<'a> Assembly<'a> {
    pub(super) fn new(surface: &'a Surface, across: &'a Neighbours, request: &'a UnwrapRequest) -> Self {
        Self {
            surface,
            across,
            request,
            pieces: Vec::new(),
            piece_of: vec![None; surface.faces.len()],
            glued: vec![[false; 3]; surface.faces.len()],
            worst_excess: request.mean_stretch - 1.0,
            local: vec![usize::MAX; surface.faces.len()],
        }
    }

    /// Adds a cluster as a piece; one that cannot be laid flat is split into faces. A face that cannot is in no piece.
    pub(super) fn add_cluster(&mut self, cluster: &[usize]) {
        let inside: BTreeSet<usize> = cluster.iter().copied().collect();
        let edges = cluster.iter().flat_map(|f| [0, 1, 2].map(|i| (*f, i)));
        let is_inside = |(f, i): &Edge| self.across[*f][*i].is_some_and(|(g, _)| inside.contains(&g));
        let edges: Vec<Edge> = edges.filter(is_inside).collect();
        match self.laid_flat(cluster, seen_along(self.surface, cluster), &edges, TRIAL) {
            Some(piece) => self.add(piece, &edges),
            None if cluster.len() > 1 => cluster.iter().for_each(|face| self.add_cluster(&[*face])),
            None => {}
        }
    }

    /// Adds a piece whose faces are also glued at these edges.
    pub(super) fn add(&mut self, piece: Piece, edges: &[Edge]) {
        for (f, i) in edges {
            self.glued[*f][*i] = true;
            if let Some((g, j)) = self.across[*f][*i] {
                self.glued[g][j] = true;
            }
        }
        for face in &piece.faces {
            self.piece_of[*face] = Some(self.pieces.len());
        }
        self.pieces.push(Some(piece));
    }

    pub(super) fn length(&self, (face, side): Edge) -> f64 {
        let corners = self.surface.corners(face);
        (corners[side] - corners[(side + 1) % 3]).norm()
    }

    /// Returns two pieces glued at these edges to one, or one piece with a slit closed; `None` if that violates a bound.
    pub(super) fn glue(&mut self, a: usize, b: usize, edges: &[Edge]) -> Option<Piece> {
        let one = self.pieces[a].clone()?;
        if a == b {
            return self.laid_flat(&one.faces, one.flat, edges, TRIAL);
        }
        let other = self.pieces[b].clone()?;
        let page = self
            .request
            .fits_mm
            .map_or(f64::INFINITY, |[width, height]| width * height);
        // Beyond this, other bounds would be violated anyway.
        if one.sums.area + other.sums.area > 1.2 * page || one.faces.len() + other.faces.len() > MOST_FACES {
            return None;
        }
        self.number(&one.faces);
        self.number(&other.faces);
        let mut pairs = Vec::new();
        for (f, i) in edges {
            let across = self.across[*f][*i]?;
            let ((f, i), (g, j)) = if self.piece_of[*f] == Some(a) {
                ((*f, *i), across)
            } else {
                (across, (*f, *i))
            };
            let (p, q) = (one.flat[self.local[f]], other.flat[self.local[g]]);
            pairs.push([p[i], q[(j + 1) % 3]]);
            pairs.push([p[(i + 1) % 3], q[j]]);
        }
        let moved = aligned(&pairs);
        let faces = [one.faces, other.faces].concat();
        let start = [one.flat, other.flat.into_iter().map(|c| c.map(&moved)).collect()].concat();
        self.laid_flat(&faces, start, edges, TRIAL)
    }

    fn number(&mut self, faces: &[usize]) {
        faces.iter().enumerate().for_each(|(n, face)| self.local[*face] = n);
    }

    /// Lays faces flat, glued as they are and at these edges, starting from their corners' positions; `None` if that violates a bound.
    fn laid_flat(
        &mut self,
        faces: &[usize],
        start: Vec<[Vector2<f64>; 3]>,
        also: &[Edge],
        (steps, least_gain): (usize, f64),
    ) -> Option<Piece> {
        self.number(faces);
        let places = self.places(faces, also);
        let on_surface: Vec<_> = faces.iter().map(|f| self.surface.corners(*f)).collect();
        let patch = Patch::new(places, &on_surface);
        let mut flat = patch.mean_places(&start);
        patch.relax(&mut flat, Energy::Rigid, UNFOLD.0, UNFOLD.1);
        let (_, sums) = self.stretch_sums(&patch, &flat);
        if sums.excess > HOPELESS * self.worst_excess * sums.area {
            return None;
        }
        patch.relax(&mut flat, Energy::Dirichlet, steps, least_gain);
        let (stretch, mut sums) = self.stretch_sums(&patch, &flat);
        let worst = stretch.iter().copied().fold(1.0, f64::max);
        if !(worst <= WORST && sums.excess <= self.worst_excess * sums.area) {
            return None;
        }
        let (paper, turn) = rectangle(flat.iter().copied(), self.request.fits_mm)?;
        sums.paper = paper;
        let sides = self.outline(faces, &patch, &flat);
        (!patch.is_overfull(&flat) && !is_crossing(&sides)).then(|| Piece {
            faces: faces.to_vec(),
            flat: (0..faces.len()).map(|f| patch.flat_corners(&flat, f)).collect(),
            stretch,
            sums,
            outline_mm: sides.iter().map(|[p, q]| (p.1 - q.1).norm()).sum(),
            turn,
        })
    }

    fn stretch_sums(&self, patch: &Patch, flat: &Flat) -> (Vec<f64>, Sums) {
        let stretch = patch.stretches(flat);
        let mut sums = Sums::default();
        for (stretch, area) in stretch.iter().zip(&patch.area) {
            sums.area += area;
            sums.excess += area * (stretch - 1.0);
            sums.above += if *stretch > self.request.stretch_99 { *area } else { 0.0 };
        }
        (stretch, sums)
    }

    /// Returns a place index for each corner of each numbered face; glued edges share theirs.
    fn places(&self, faces: &[usize], also: &[Edge]) -> Vec<[usize; 3]> {
        let mut places = UnionFind::new(3 * faces.len());
        let edges = faces.iter().flat_map(|f| [0, 1, 2].map(|i| (*f, i)));
        let glued = edges.filter(|(f, i)| self.glued[*f][*i]);
        for (f, i) in glued.chain(also.iter().copied()) {
            let Some((g, j)) = self.across[f][i] else {
                continue;
            };
            let (f, g) = (self.local[f], self.local[g]);
            places.unite(3 * f + i, 3 * g + (j + 1) % 3);
            places.unite(3 * f + (i + 1) % 3, 3 * g + j);
        }
        let (mut name, mut count) = (vec![None; 3 * faces.len()], 0);
        let mut named = |corner: usize| {
            *name[places.root(corner)].get_or_insert_with(|| {
                count += 1;
                count - 1
            })
        };
        (0..faces.len()).map(|f| [0, 1, 2].map(|i| named(3 * f + i))).collect()
    }

    /// Returns the sides of the numbered faces without a neighbour on the paper.
    fn outline(&self, faces: &[usize], patch: &Patch, flat: &Flat) -> Vec<Side> {
        let mut sides = Vec::new();
        for (corners, face) in patch.corners.iter().zip(faces) {
            for i in 0..3 {
                let ends = [corners[i], corners[(i + 1) % 3]];
                let is_inside = self.across[*face][i].is_some_and(|(g, j)| {
                    let n = self.local[g];
                    let other = patch.corners.get(n).filter(|_| faces[n] == g);
                    other.is_some_and(|other| [other[(j + 1) % 3], other[j]] == ends)
                });
                if !is_inside {
                    sides.push(ends.map(|p| (p, flat[p])));
                }
            }
        }
        sides
    }

    /// Returns the pieces with minimised stretch, each rotated into its smallest rectangle, which starts at 0, 0.
    pub(super) fn finish(mut self) -> Vec<Piece> {
        let pieces = std::mem::take(&mut self.pieces).into_iter().flatten();
        pieces.map(|piece| self.finished(piece)).collect()
    }

    fn finished(&mut self, mut piece: Piece) -> Piece {
        let better = self.laid_flat(&piece.faces, piece.flat.clone(), &[], FINAL);
        if let Some(better) = better
            && better.sums.excess <= piece.sums.excess
            && better.sums.above <= piece.sums.above
        {
            piece = better;
        }
        let (sin, cos) = piece.turn.sin_cos();
        for p in piece.flat.iter_mut().flatten() {
            *p = Vector2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
        }
        let corners = piece.flat.iter().flatten();
        let low = corners.fold(Vector2::from([f64::INFINITY; 2]), |low, p| low.inf(p));
        piece.flat.iter_mut().flatten().for_each(|p| *p -= low);
        piece
    }
}

/// Returns the rigid motion that best maps the second of each pair onto the first (Schönemann 1966).
fn aligned(pairs: &[[Vector2<f64>; 2]]) -> impl Fn(Vector2<f64>) -> Vector2<f64> + use<> {
    let mean = |i: usize| pairs.iter().map(|p| p[i]).sum::<Vector2<f64>>() / pairs.len().max(1) as f64;
    let (to, from) = (mean(0), mean(1));
    let (mut cos, mut sin) = (0.0, 0.0);
    for [p, q] in pairs {
        cos += (q - from).dot(&(p - to));
        sin += (q - from).perp(&(p - to));
    }
    let length = cos.hypot(sin);
    let (cos, sin) = if length > 0.0 {
        (cos / length, sin / length)
    } else {
        (1.0, 0.0)
    };
    move |p| {
        let p = p - from;
        to + Vector2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y)
    }
}

/// Projects the corners of faces along the first one's normal.
fn seen_along(surface: &Surface, faces: &[usize]) -> Vec<[Vector2<f64>; 3]> {
    let Some(first) = faces.first() else { return Vec::new() };
    let corners = surface.corners(*first);
    let normal = doubled_area(&corners).normalize();
    let x = (corners[1] - corners[0]).normalize();
    let y = normal.cross(&x);
    let seen = |f: &usize| {
        surface
            .corners(*f)
            .map(|p| p - corners[0])
            .map(|p| Vector2::new(p.dot(&x), p.dot(&y)))
    };
    faces.iter().map(seen).collect()
}
