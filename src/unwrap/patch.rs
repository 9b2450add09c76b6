//! Some faces glued together, and laid flat as rigidly as possible.

use nalgebra::{Point3, Vector2};

use super::stretch::{laid, singular_values, stretch};

/// Steps of the conjugate gradients in one global step.
const CG_STEPS: usize = 200;

/// Faces that share corners where they are glued.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Into the places.
    pub corners: Vec<[usize; 3]>,
    /// How many places there are.
    pub places: usize,
    laid: Vec<[Vector2<f64>; 2]>,
    pub area: Vec<f64>,
    /// The cotangent of the angle at each corner.
    cotangents: Vec<[f64; 3]>,
}

/// Where each place lies on the paper.
pub(super) type Flat = Vec<Vector2<f64>>;

impl Patch {
    pub(super) fn new(corners: Vec<[usize; 3]>, places: usize, on_surface: &[[Point3<f64>; 3]]) -> Self {
        let laid: Vec<_> = on_surface.iter().map(laid).collect();
        let area: Vec<f64> = laid.iter().map(|[b, c]| 0.5 * b.x * c.y).collect();
        let cotangents = laid.iter().zip(&area).map(|([b, c], area)| {
            let side = [c - b, -c, *b];
            [0, 1, 2].map(|i: usize| -side[(i + 1) % 3].dot(&side[(i + 2) % 3]) / (2.0 * area))
        });
        Self {
            corners,
            places,
            cotangents: cotangents.collect(),
            laid,
            area,
        }
    }

    pub(super) fn flat_corners(&self, flat: &Flat, face: usize) -> [Vector2<f64>; 3] {
        self.corners[face].map(|c| flat[c])
    }

    /// The stretch of each face.
    pub(super) fn stretches(&self, flat: &Flat) -> Vec<f64> {
        let faces = 0..self.corners.len();
        faces.map(|f| stretch(self.singular_values(flat, f))).collect()
    }

    fn singular_values(&self, flat: &Flat, face: usize) -> [f64; 2] {
        singular_values(&self.laid[face], &self.flat_corners(flat, face))
    }

    /// As rigid as possible, by local and global steps (Liu et al. 2008), until a step lowers the energy by less than a share.
    pub(super) fn relax(&self, flat: &mut Flat, steps: usize, least_gain: f64) {
        let matrix = self.laplacian();
        let mut energy = f64::INFINITY;
        for _ in 0..steps {
            let (right_side, now) = self.rotated(flat);
            if !(now < energy * (1.0 - least_gain)) {
                break;
            }
            energy = now;
            matrix.solve(&right_side, flat);
        }
    }

    /// The local step: each face turned as it lies best; what the global step then solves for, and the energy before it.
    fn rotated(&self, flat: &Flat) -> (Flat, f64) {
        let mut right_side = vec![Vector2::zeros(); self.places];
        let mut energy = 0.0;
        for (f, corners) in self.corners.iter().enumerate() {
            let [b, c] = self.laid[f];
            let own = [Vector2::zeros(), b, c];
            let lies = corners.map(|c| flat[c]);
            let (mut cos, mut sin) = (0.0, 0.0);
            let sides = [0, 1, 2].map(|i: usize| {
                let (from, to) = ((i + 1) % 3, (i + 2) % 3);
                (
                    from,
                    to,
                    self.cotangents[f][i],
                    own[to] - own[from],
                    lies[to] - lies[from],
                )
            });
            for (_, _, weight, own, lies) in &sides {
                cos += weight * own.dot(lies);
                sin += weight * own.perp(lies);
            }
            let length = cos.hypot(sin).max(f64::MIN_POSITIVE);
            (cos, sin) = (cos / length, sin / length);
            for (from, to, weight, own, lies) in sides {
                let turned = Vector2::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y);
                right_side[corners[to]] += weight * turned;
                right_side[corners[from]] -= weight * turned;
                energy += weight * (lies - turned).norm_squared();
            }
        }
        (right_side, energy)
    }

    fn laplacian(&self) -> Laplacian {
        let mut entries: Vec<(usize, usize, f64)> = Vec::with_capacity(6 * self.corners.len());
        for (corners, cotangents) in self.corners.iter().zip(&self.cotangents) {
            for i in 0..3 {
                let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                entries.push((from, to, cotangents[i]));
                entries.push((to, from, cotangents[i]));
            }
        }
        entries.sort_by_key(|(from, to, _)| (*from, *to));
        let mut rows = vec![0; self.places + 1];
        let mut columns: Vec<(usize, f64)> = Vec::new();
        let mut diagonal = vec![0.0; self.places];
        let mut last = None;
        for (from, to, weight) in entries {
            diagonal[from] += weight;
            match columns.last_mut() {
                Some(entry) if last == Some((from, to)) => entry.1 += weight,
                _ => columns.push((to, weight)),
            }
            last = Some((from, to));
            rows[from + 1] = columns.len();
        }
        Laplacian {
            rows,
            columns,
            diagonal,
        }
    }
}

/// The sparse matrix of the global step, symmetric and positive up to a shift of everything.
struct Laplacian {
    /// Where each row's entries start among the columns, and the end.
    rows: Vec<usize>,
    columns: Vec<(usize, f64)>,
    diagonal: Vec<f64>,
}

impl Laplacian {
    fn times(&self, x: &Flat) -> Flat {
        let row = |i: usize| {
            let entries = &self.columns[self.rows[i]..self.rows[i + 1]];
            entries
                .iter()
                .fold(self.diagonal[i] * x[i], |sum, (j, weight)| sum - *weight * x[*j])
        };
        (0..x.len()).map(row).collect()
    }

    /// Both coordinates by conjugate gradients with the diagonal as preconditioner, from where they are.
    fn solve(&self, right_side: &Flat, x: &mut Flat) {
        let scaled = |r: &Flat| -> Flat { r.iter().zip(&self.diagonal).map(|(r, d)| r / d.max(1e-12)).collect() };
        let dot = |a: &Flat, b: &Flat| -> Vector2<f64> { a.iter().zip(b).map(|(a, b)| a.component_mul(b)).sum() };
        let ratio = |a: Vector2<f64>, b: Vector2<f64>| a.zip_map(&b, |a, b| if b.abs() > 1e-300 { a / b } else { 0.0 });
        let mut residual: Flat = right_side.iter().zip(self.times(x)).map(|(b, ax)| b - ax).collect();
        let mut step = scaled(&residual);
        let mut size = dot(&residual, &step);
        let enough = 1e-10 * dot(right_side, &scaled(right_side)).sum();
        for _ in 0..CG_STEPS {
            if !(size.sum() > enough) {
                break;
            }
            let along = self.times(&step);
            let by = ratio(size, dot(&step, &along));
            for i in 0..x.len() {
                x[i] += by.component_mul(&step[i]);
                residual[i] -= by.component_mul(&along[i]);
            }
            let scaled = scaled(&residual);
            let new = dot(&residual, &scaled);
            let keep = ratio(new, size);
            size = new;
            for i in 0..x.len() {
                step[i] = scaled[i] + keep.component_mul(&step[i]);
            }
        }
    }
}
