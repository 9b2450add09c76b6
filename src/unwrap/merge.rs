//! Pieces are glued together, the ones that cost least stretch for the border they save first, as long as all bounds are kept.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use nalgebra::Vector2;

use super::outline::{Rectangle, Side, is_crossing, rectangle};
use super::patch::{Flat, Patch};
use super::surface::Surface;
use super::topology::Topology;
use super::{LEFT_OUT, UnwrapRequest};

/// Steps and least gain of a trial, and of what is kept in the end.
const TRIAL: (usize, f64) = (25, 2e-3);
const FINAL: (usize, f64) = (200, 1e-5);
/// How much is done for few pieces: the first level always, the others in turn while there are too many.
const LEVELS: [Level; 3] = [
    Level {
        worst_excess: 1.0,
        paper_mm: 6.0,
    },
    Level {
        worst_excess: 2.0,
        paper_mm: 30.0,
    },
    Level {
        worst_excess: 4.0,
        paper_mm: f64::INFINITY,
    },
];
/// A seam costs as much as this stretch of the smaller piece: pieces of no stretch at all are glued along their longest borders.
const SEAM: f64 = 0.002;

struct Level {
    /// No piece is stretched by more than so many times what is asked for in the mean.
    worst_excess: f64,
    /// Glued pieces may take this more paper, as rectangles, than apart: mm² per mm of the border they save.
    paper_mm: f64,
}

/// Faces that are flat together.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub faces: Vec<usize>,
    pub flat: Vec<[Vector2<f64>; 3]>,
    pub stretch: Vec<f64>,
    pub area: f64,
    /// The area times what the stretch exceeds 1.
    excess: f64,
    /// The area that is stretched beyond the 99th percentile that is asked for.
    above: f64,
    outline_mm: f64,
    /// The smallest rectangle around it.
    paper_mm2: f64,
    turn: f64,
}

/// An edge of a face.
type Edge = (usize, usize);

pub(super) struct Merge<'a> {
    surface: &'a Surface,
    topology: &'a Topology,
    request: &'a UnwrapRequest,
    pieces: Vec<Option<Piece>>,
    piece_of: Vec<usize>,
    glued: Vec<[bool; 3]>,
    area: f64,
    /// Where each face is among those of a patch that is being made.
    local: Vec<usize>,
    pub tried: usize,
    level: &'static Level,
}

/// Two pieces that may be glued.
struct Trial {
    edges: Vec<Edge>,
    /// What came of it; `None` before it was tried.
    made: Option<Piece>,
}

type Pair = (usize, usize);
/// Cost, pair, and which trial of it.
type Entry = Reverse<(u64, usize)>;

impl<'a> Merge<'a> {
    pub(super) fn new(
        surface: &'a Surface,
        topology: &'a Topology,
        request: &'a UnwrapRequest,
        clusters: Vec<Vec<usize>>,
    ) -> Self {
        let mut merge = Self {
            surface,
            topology,
            request,
            pieces: Vec::new(),
            piece_of: vec![usize::MAX; surface.faces.len()],
            glued: vec![[false; 3]; surface.faces.len()],
            area: clusters.iter().flatten().map(|f| surface.area(*f)).sum(),
            local: vec![usize::MAX; surface.faces.len()],
            tried: 0,
            level: &LEVELS[0],
        };
        for cluster in clusters {
            merge.add_cluster(cluster);
        }
        merge
    }

    /// A cluster that is flat as it is; one that is not is taken apart.
    fn add_cluster(&mut self, cluster: Vec<usize>) {
        let inside: BTreeSet<usize> = cluster.iter().copied().collect();
        let edges: Vec<Edge> = cluster
            .iter()
            .flat_map(|f| (0..3).map(|i| (*f, i)))
            .filter(|(f, i)| self.topology.across[*f][*i].is_some_and(|(g, _)| inside.contains(&g)))
            .collect();
        let start = seen_along(self.surface, &cluster);
        match self.laid_flat(&cluster, start, &edges, TRIAL) {
            Some(piece) => self.add(piece, &edges),
            None => {
                for face in cluster {
                    let start = seen_along(self.surface, &[face]);
                    if let Some(piece) = self.laid_flat(&[face], start, &[], TRIAL) {
                        self.add(piece, &[]);
                    }
                }
            }
        }
    }

    fn add(&mut self, piece: Piece, edges: &[Edge]) {
        for (f, i) in edges {
            self.glued[*f][*i] = true;
            if let Some((g, j)) = self.topology.across[*f][*i] {
                self.glued[g][j] = true;
            }
        }
        for face in &piece.faces {
            self.piece_of[*face] = self.pieces.len();
        }
        self.pieces.push(Some(piece));
    }

    /// Glues until nothing more can be glued, or few enough pieces are left after the first level.
    pub(super) fn run(&mut self, progress: &mut dyn FnMut(f64)) {
        for (done, level) in LEVELS.iter().enumerate() {
            if done > 0 && self.are_few() {
                break;
            }
            self.level = level;
            self.run_level(done > 0, progress);
        }
    }

    fn are_few(&self) -> bool {
        let areas = self.pieces.iter().flatten().map(|p| p.area).collect();
        self.request.most_pieces.is_none_or(|most| needed(areas) <= most)
    }

    fn run_level(&mut self, is_extra: bool, progress: &mut dyn FnMut(f64)) {
        let mut trials: Vec<(Pair, Trial)> = Vec::new();
        let mut queue: BinaryHeap<Entry> = BinaryHeap::new();
        for (pair, edges) in self.borders(None) {
            self.push(pair, edges, &mut trials, &mut queue);
        }
        let first = self.pieces.len() as f64;
        let (mut excess, mut above) = self.totals();
        while let Some(Reverse((_, index))) = queue.pop() {
            let (pair, trial) = &mut trials[index];
            let (a, b) = *pair;
            let Some(made) = trial.made.take() else { continue };
            let (Some(one), Some(other)) = (&self.pieces[a], &self.pieces[b]) else {
                continue;
            };
            let more = made.excess - one.excess - other.excess;
            let more_above = made.above - one.above - other.above;
            if excess + more > (self.request.mean_stretch - 1.0) * self.area
                || above + more_above.max(0.0) > 0.0095 * self.area
            {
                continue;
            }
            excess += more;
            above += more_above;
            let edges = std::mem::take(&mut trial.edges);
            (self.pieces[a], self.pieces[b]) = (None, None);
            self.add(made, &edges);
            progress((self.pieces.len() as f64 / (2.0 * first)).min(1.0));
            if is_extra && self.are_few() {
                return;
            }
            let new = self.pieces.len() - 1;
            for (pair, edges) in self.borders(Some(new)) {
                self.push(pair, edges, &mut trials, &mut queue);
            }
        }
    }

    fn totals(&self) -> (f64, f64) {
        let pieces = self.pieces.iter().flatten();
        pieces.fold((0.0, 0.0), |(e, a), p| (e + p.excess, a + p.above))
    }

    /// The edges between each two pieces; only those of one piece if one is given.
    fn borders(&self, of: Option<usize>) -> BTreeMap<Pair, Vec<Edge>> {
        let mut borders: BTreeMap<Pair, Vec<Edge>> = BTreeMap::new();
        let pieces = of.map_or(0..self.pieces.len(), |one| one..one + 1);
        for face in pieces.filter_map(|p| self.pieces[p].as_ref()).flat_map(|p| &p.faces) {
            for (side, across) in self.topology.across[*face].iter().enumerate() {
                let Some((other, _)) = *across else { continue };
                let (a, b) = (self.piece_of[*face], self.piece_of[other]);
                if b == usize::MAX {
                    continue;
                }
                if a < b || (of.is_some() && a != b) {
                    borders.entry((a, b)).or_default().push((*face, side));
                }
            }
        }
        borders
    }

    fn push(&mut self, pair: Pair, edges: Vec<Edge>, trials: &mut Vec<(Pair, Trial)>, queue: &mut BinaryHeap<Entry>) {
        if self.try_to_push(pair, &edges, trials, queue) {
            return;
        }
        let runs = self.runs(&edges);
        if runs.len() > 1 {
            for run in runs {
                self.try_to_push(pair, &run, trials, queue);
            }
        }
    }

    fn try_to_push(
        &mut self,
        pair: Pair,
        edges: &[Edge],
        trials: &mut Vec<(Pair, Trial)>,
        queue: &mut BinaryHeap<Entry>,
    ) -> bool {
        let Some(made) = self.glue(pair, edges) else {
            return false;
        };
        let (Some(a), Some(b)) = (&self.pieces[pair.0], &self.pieces[pair.1]) else {
            return false;
        };
        let border: f64 = edges.iter().map(|e| self.length(*e)).sum();
        let share = border / a.outline_mm.min(b.outline_mm);
        if made.paper_mm2 > a.paper_mm2 + b.paper_mm2 + self.level.paper_mm * border {
            return false;
        }
        let more = (made.excess - a.excess - b.excess).max(0.0);
        let cost = (more + SEAM * a.area.min(b.area)) / (share + 0.05).powi(2);
        queue.push(Reverse((cost.to_bits(), trials.len())));
        trials.push((
            pair,
            Trial {
                edges: edges.to_vec(),
                made: Some(made),
            },
        ));
        true
    }

    /// The edges in chains that have no corner in common.
    fn runs(&self, edges: &[Edge]) -> Vec<Vec<Edge>> {
        let mut runs: Vec<(BTreeSet<usize>, Vec<Edge>)> = Vec::new();
        for (f, i) in edges {
            let corners = &self.surface.faces[*f].corners;
            let ends = [corners[*i], corners[(i + 1) % 3]];
            let (mine, rest): (Vec<_>, Vec<_>) =
                runs.into_iter().partition(|(c, _)| ends.iter().any(|e| c.contains(e)));
            runs = rest;
            let mut run = (BTreeSet::from(ends), vec![(*f, *i)]);
            for (corners, edges) in mine {
                run.0.extend(corners);
                run.1.extend(edges);
            }
            runs.push(run);
        }
        runs.into_iter().map(|(_, edges)| edges).collect()
    }

    fn length(&self, (face, side): Edge) -> f64 {
        let corners = self.surface.corners(face);
        (corners[side] - corners[(side + 1) % 3]).norm()
    }

    /// Both pieces as one, glued at these edges; `None` if that breaks a bound.
    fn glue(&mut self, (a, b): Pair, edges: &[Edge]) -> Option<Piece> {
        self.tried += 1;
        let (one, other) = (self.pieces[a].clone()?, self.pieces[b].clone()?);
        if let Some([width, height]) = self.request.fits_mm
            && one.area + other.area > 1.05 * width * height
        {
            return None;
        }
        let at = |piece: &Piece, face: usize| piece.faces.iter().position(|f| *f == face).map(|i| piece.flat[i]);
        let mut pairs: Vec<[Vector2<f64>; 2]> = Vec::new();
        for (f, i) in edges {
            let (g, j) = self.topology.across[*f][*i]?;
            let (p, q, f, i, g, j) = if self.piece_of[*f] == a {
                (&one, &other, *f, *i, g, j)
            } else {
                (&one, &other, g, j, *f, *i)
            };
            let (p, q) = (at(p, f)?, at(q, g)?);
            pairs.push([p[i], q[(j + 1) % 3]]);
            pairs.push([p[(i + 1) % 3], q[j]]);
        }
        let moved = aligned(&pairs);
        let faces = [one.faces, other.faces].concat();
        let start = [one.flat, other.flat.into_iter().map(|c| c.map(&moved)).collect()].concat();
        self.laid_flat(&faces, start, edges, TRIAL)
    }

    /// Faces glued as they are and at these edges, too, from where their corners are; `None` if that breaks a bound.
    fn laid_flat(
        &mut self,
        faces: &[usize],
        start: Vec<[Vector2<f64>; 3]>,
        also: &[Edge],
        (steps, least_gain): (usize, f64),
    ) -> Option<Piece> {
        let places = self.places(faces, also);
        let count = places.iter().flatten().max()? + 1;
        let on_surface: Vec<_> = faces.iter().map(|f| self.surface.corners(*f)).collect();
        let patch = Patch::new(places, count, &on_surface);
        let mut flat: Flat = vec![Vector2::zeros(); count];
        let mut met = vec![0.0; count];
        for (places, lies) in patch.corners.iter().zip(start) {
            for (place, p) in places.iter().zip(lies) {
                flat[*place] += p;
                met[*place] += 1.0;
            }
        }
        flat.iter_mut().zip(met).for_each(|(p, n)| *p /= n);
        patch.relax(&mut flat, steps, least_gain);
        let stretch = patch.stretches(&flat);
        let (mut area, mut excess, mut above) = (0.0, 0.0, 0.0);
        for (stretch, face) in stretch.iter().zip(&patch.area) {
            area += face;
            excess += face * (stretch - 1.0);
            above += if *stretch > self.request.stretch_99 { *face } else { 0.0 };
        }
        if !(excess <= self.level.worst_excess * (self.request.mean_stretch - 1.0) * area) {
            return None;
        }
        let Rectangle { area: paper_mm2, turn } = rectangle(flat.iter().copied(), self.request.fits_mm)?;
        let sides = self.outline(faces, &patch, &flat, also);
        if is_crossing(&sides) {
            return None;
        }
        Some(Piece {
            faces: faces.to_vec(),
            flat: (0..faces.len()).map(|f| patch.flat_corners(&flat, f)).collect(),
            stretch,
            area,
            excess,
            above,
            paper_mm2,
            turn,
            outline_mm: sides.iter().map(|[p, q]| (p.1 - q.1).norm()).sum(),
        })
    }

    /// A place for each corner of each face; glued edges share theirs.
    fn places(&mut self, faces: &[usize], also: &[Edge]) -> Vec<[usize; 3]> {
        let mut parent: Vec<usize> = (0..3 * faces.len()).collect();
        fn root(parent: &mut [usize], mut i: usize) -> usize {
            while parent[i] != i {
                parent[i] = parent[parent[i]];
                i = parent[i];
            }
            i
        }
        for (n, face) in faces.iter().enumerate() {
            self.local[*face] = n;
        }
        let glued = faces
            .iter()
            .flat_map(|f| (0..3).map(|i| (*f, i)))
            .filter(|(f, i)| self.glued[*f][*i]);
        for (f, i) in glued.chain(also.iter().copied()) {
            let Some((g, j)) = self.topology.across[f][i] else {
                continue;
            };
            let (f, g) = (self.local[f], self.local[g]);
            for (p, q) in [(3 * f + i, 3 * g + (j + 1) % 3), (3 * f + (i + 1) % 3, 3 * g + j)] {
                let (p, q) = (root(&mut parent, p), root(&mut parent, q));
                parent[p.max(q)] = p.min(q);
            }
        }
        let mut name = vec![usize::MAX; parent.len()];
        let mut count = 0;
        let places = (0..faces.len()).map(|f| {
            [0, 1, 2].map(|i| {
                let root = root(&mut parent, 3 * f + i);
                if name[root] == usize::MAX {
                    name[root] = count;
                    count += 1;
                }
                name[root]
            })
        });
        places.collect()
    }

    /// The sides with nothing beside them on the paper. `local` is as `places` has left it.
    fn outline(&self, faces: &[usize], patch: &Patch, flat: &Flat, _also: &[Edge]) -> Vec<Side> {
        let mut sides = Vec::new();
        for (n, face) in faces.iter().enumerate() {
            for i in 0..3 {
                let ends = [patch.corners[n][i], patch.corners[n][(i + 1) % 3]];
                let is_inside = self.topology.across[*face][i].is_some_and(|(g, j)| {
                    let g = self.local[g];
                    faces
                        .get(g)
                        .is_some_and(|other| self.topology.across[*face][i].is_some_and(|(f, _)| f == *other))
                        && [patch.corners[g][(j + 1) % 3], patch.corners[g][j]] == ends
                });
                if !is_inside {
                    sides.push(ends.map(|p| (p, flat[p])));
                }
            }
        }
        sides
    }

    /// The pieces as rigid as they get, each turned so that it fits.
    pub(super) fn finish(mut self) -> Vec<Piece> {
        let pieces: Vec<Piece> = std::mem::take(&mut self.pieces).into_iter().flatten().collect();
        let finish = |piece: Piece| {
            let better = self.laid_flat(&piece.faces, piece.flat.clone(), &[], FINAL);
            let mut piece = better
                .filter(|b| b.excess <= piece.excess && b.above <= piece.above)
                .unwrap_or(piece);
            let (sin, cos) = piece.turn.sin_cos();
            let turned = |p: &mut Vector2<f64>| *p = Vector2::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
            piece.flat.iter_mut().flatten().for_each(turned);
            let low = piece
                .flat
                .iter()
                .flatten()
                .fold(Vector2::from([f64::INFINITY; 2]), |l, p| l.inf(p));
            piece.flat.iter_mut().flatten().for_each(|p| *p -= low);
            piece
        };
        pieces.into_iter().map(finish).collect()
    }
}

/// How many of the largest have all the area but the share that may be left out.
pub(super) fn needed(mut areas: Vec<f64>) -> usize {
    areas.sort_by(f64::total_cmp);
    let mut left = LEFT_OUT * areas.iter().sum::<f64>();
    let small = areas.iter().take_while(|area| {
        left -= *area;
        left >= 0.0
    });
    areas.len() - small.count()
}

/// How to move the second of each pair so that it lies on the first, without stretch (Schönemann 1966).
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

/// The corners of faces seen along the first one's normal.
fn seen_along(surface: &Surface, faces: &[usize]) -> Vec<[Vector2<f64>; 3]> {
    let Some(first) = faces.first() else { return Vec::new() };
    let corners = surface.corners(*first);
    let normal = crate::mesh::doubled_area(&corners).normalize();
    let x = (corners[1] - corners[0]).normalize();
    let y = normal.cross(&x);
    let seen = |f: &usize| {
        surface
            .corners(*f)
            .map(|p| Vector2::new(p.coords.dot(&x), p.coords.dot(&y)))
    };
    faces.iter().map(seen).collect()
}
