//! Faces glued together, and laid flat with little stretch.

use nalgebra::{Matrix2, Point3, Vector2};

/// Maximum number of conjugate gradient steps in one global step, and the relative residual at which they end.
const SOLVER: (usize, f64) = (150, 1e-8);
/// Maximum number of halvings of a step that does not lower the energy.
const HALVINGS: usize = 10;

/// Faces that share corners at glued edges.
#[derive(Debug, Clone)]
pub(super) struct Patch {
    /// Place indices of the corners.
    pub corners: Vec<[usize; 3]>,
    places: usize,
    laid: Vec<[Vector2<f64>; 2]>,
    pub area: Vec<f64>,
    /// Gradients of each corner's barycentric coordinate over the laid face.
    gradients: Vec<[Vector2<f64>; 3]>,
}

/// Position of each place on the paper.
pub(super) type Flat = Vec<Vector2<f64>>;

/// Energy to minimise, integrated over the area; s are the singular values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Energy {
    /// (s − 1)²: as rigid as possible (Liu et al. 2008). It unfolds initially flipped faces.
    Rigid,
    /// s² + 1/s²: symmetric Dirichlet (Smith and Schaefer 2015), which limits the stretch of single faces, and prevents flips.
    Dirichlet,
}

impl Energy {
    fn value(self, s: f64) -> f64 {
        match self {
            Self::Rigid => (s - 1.0).powi(2),
            Self::Dirichlet if s > 0.0 => s * s + 1.0 / (s * s),
            Self::Dirichlet => f64::INFINITY,
        }
    }

    /// Returns the weight of (s − 1)² that gives the energy's derivative (Rabinovich et al. 2017).
    fn weight(self, s: f64) -> f64 {
        match self {
            Self::Rigid => 1.0,
            Self::Dirichlet => (s + 1.0) * (s * s + 1.0) / (s * s * s),
        }
    }
}

impl Patch {
    pub(super) fn new(corners: Vec<[usize; 3]>, on_surface: &[[Point3<f64>; 3]]) -> Self {
        let laid: Vec<_> = on_surface.iter().map(laid).collect();
        let area: Vec<f64> = laid.iter().map(|[b, c]| 0.5 * b.x * c.y).collect();
        let gradients = laid.iter().zip(&area).map(|([b, c], area)| {
            let at_b = Vector2::new(c.y, -c.x) / (2.0 * area);
            let at_c = Vector2::new(0.0, b.x) / (2.0 * area);
            [-at_b - at_c, at_b, at_c]
        });
        Self {
            places: corners.iter().flatten().max().map_or(0, |last| last + 1),
            corners,
            gradients: gradients.collect(),
            laid,
            area,
        }
    }

    /// Returns each place at the mean of its positions in the faces.
    pub(super) fn mean_places(&self, start: &[[Vector2<f64>; 3]]) -> Flat {
        let (mut flat, mut met) = (vec![Vector2::zeros(); self.places], vec![0.0; self.places]);
        for (places, lies) in self.corners.iter().zip(start) {
            for (place, p) in places.iter().zip(lies) {
                flat[*place] += p;
                met[*place] += 1.0;
            }
        }
        flat.iter_mut().zip(met).for_each(|(p, n)| *p /= n);
        flat
    }

    pub(super) fn flat_corners(&self, flat: &Flat, face: usize) -> [Vector2<f64>; 3] {
        self.corners[face].map(|c| flat[c])
    }

    pub(super) fn stretches(&self, flat: &Flat) -> Vec<f64> {
        let faces = 0..self.corners.len();
        faces.map(|f| stretch(self.singular_values(flat, f))).collect()
    }

    /// Returns true if the faces around a place have an angle sum of more than a full turn, and so overlap.
    pub(super) fn is_overfull(&self, flat: &Flat) -> bool {
        let mut angle = vec![0.0; self.places];
        for (f, places) in self.corners.iter().enumerate() {
            let lies = self.flat_corners(flat, f);
            for (i, place) in places.iter().enumerate() {
                let (p, q) = (lies[(i + 1) % 3] - lies[i], lies[(i + 2) % 3] - lies[i]);
                angle[*place] += p.perp(&q).atan2(p.dot(&q));
            }
        }
        angle.into_iter().any(|angle| angle > std::f64::consts::TAU + 1e-6)
    }

    fn singular_values(&self, flat: &Flat, face: usize) -> [f64; 2] {
        singular_values(&self.laid[face], &self.flat_corners(flat, face))
    }

    fn energy(&self, flat: &Flat, energy: Energy) -> f64 {
        let density = |f: usize| -> f64 { self.singular_values(flat, f).into_iter().map(|s| energy.value(s)).sum() };
        (0..self.corners.len()).map(|f| self.area[f] * density(f)).sum()
    }

    /// Minimises the energy by local and global steps, until one lowers it by less than a share.
    pub(super) fn relax(&self, flat: &mut Flat, energy: Energy, steps: usize, least_gain: f64) {
        let mut now = self.energy(flat, energy);
        let unstretched = 2.0 * energy.value(1.0) * self.area.iter().sum::<f64>();
        for _ in 0..steps {
            if !now.is_finite() {
                break;
            }
            let mut next = flat.clone();
            let system = self.local_step(flat, energy);
            system.solve(&mut next);
            let mut after = self.energy(&next, energy);
            for _ in 0..HALVINGS {
                if after <= now {
                    break;
                }
                next.iter_mut().zip(&*flat).for_each(|(n, old)| *n = 0.5 * (*n + old));
                after = self.energy(&next, energy);
            }
            if after.is_nan() || after > now {
                break;
            }
            *flat = next;
            // An energy that is already minimal has nothing to gain.
            let is_done = now - after <= least_gain * (after - unstretched) + 1e-12 * now;
            now = after;
            if is_done {
                break;
            }
        }
    }

    /// Local step: best rotation of each face, and the weights of its remaining deformation.
    fn local_step(&self, flat: &Flat, energy: Energy) -> System<'_> {
        let mut weights = Vec::with_capacity(self.corners.len());
        let mut right_side = vec![Vector2::zeros(); self.places];
        let mut diagonal = vec![Matrix2::zeros(); self.places];
        for (f, corners) in self.corners.iter().enumerate() {
            let map = self.map(flat, f);
            let turn = Vector2::new(map[(0, 0)] + map[(1, 1)], map[(1, 0)] - map[(0, 1)]);
            let turn = turn.try_normalize(1e-300).unwrap_or(Vector2::x());
            let turn = Matrix2::new(turn.x, -turn.y, turn.y, turn.x);
            let weight = self.area[f] * self.weight(flat, f, &(map * turn.transpose()), energy);
            for (corner, gradient) in corners.iter().zip(&self.gradients[f]) {
                right_side[*corner] += weight * turn * gradient;
                diagonal[*corner] += weight * gradient.norm_squared();
            }
            weights.push(weight);
        }
        let inverse = |m: Matrix2<f64>| m.try_inverse().unwrap_or_else(Matrix2::zeros);
        System {
            patch: self,
            weights,
            right_side,
            preconditioner: diagonal.into_iter().map(inverse).collect(),
        }
    }

    /// Returns the weight as a function of the symmetric part of the map.
    fn weight(&self, flat: &Flat, face: usize, symmetric: &Matrix2<f64>, energy: Energy) -> Matrix2<f64> {
        if energy == Energy::Rigid {
            return Matrix2::identity();
        }
        let [large, small] = self.singular_values(flat, face);
        let (at_large, at_small) = (energy.weight(large), energy.weight(small));
        if large - small < 1e-9 {
            return Matrix2::identity() * at_large;
        }
        let slope = (at_large - at_small) / (large - small);
        Matrix2::identity() * (at_large - slope * large) + slope * symmetric
    }

    /// Returns the linear part of the affine map from the laid face to the paper.
    fn map(&self, flat: &Flat, face: usize) -> Matrix2<f64> {
        let terms = self.corners[face].iter().zip(&self.gradients[face]);
        terms
            .map(|(corner, gradient)| flat[*corner] * gradient.transpose())
            .sum()
    }
}

/// Global step: the places whose maps are nearest to the rotated faces.
struct System<'a> {
    patch: &'a Patch,
    weights: Vec<Matrix2<f64>>,
    right_side: Flat,
    preconditioner: Vec<Matrix2<f64>>,
}

impl System<'_> {
    fn times(&self, x: &Flat) -> Flat {
        let mut product = vec![Vector2::zeros(); x.len()];
        for (f, weight) in self.weights.iter().enumerate() {
            let map = weight * self.patch.map(x, f);
            for (corner, gradient) in self.patch.corners[f].iter().zip(&self.patch.gradients[f]) {
                product[*corner] += map * gradient;
            }
        }
        product
    }

    /// Solves by preconditioned conjugate gradients, starting from the current places.
    fn solve(&self, x: &mut Flat) {
        let dot = |a: &Flat, b: &Flat| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let scaled = |r: &Flat| -> Flat { r.iter().zip(&self.preconditioner).map(|(r, p)| p * r).collect() };
        let mut residual: Flat = self
            .right_side
            .iter()
            .zip(self.times(x))
            .map(|(b, ax)| b - ax)
            .collect();
        let mut step = scaled(&residual);
        let mut size = dot(&residual, &step);
        let enough = SOLVER.1 * dot(&self.right_side, &scaled(&self.right_side)).max(f64::MIN_POSITIVE);
        for _ in 0..SOLVER.0 {
            if size.is_nan() || size <= enough {
                break;
            }
            let along = self.times(&step);
            let by = size / dot(&step, &along);
            if !by.is_finite() {
                break;
            }
            for i in 0..x.len() {
                x[i] += by * step[i];
                residual[i] -= by * along[i];
            }
            let scaled = scaled(&residual);
            let new = dot(&residual, &scaled);
            for i in 0..x.len() {
                step[i] = scaled[i] + new / size * step[i];
            }
            size = new;
        }
    }
}

/// Lays a triangle of the surface into the plane without stretch: its first corner at the origin, its second on the x axis.
fn laid(corners: &[Point3<f64>; 3]) -> [Vector2<f64>; 2] {
    let (b, c) = (corners[1] - corners[0], corners[2] - corners[0]);
    let length = b.norm();
    [
        Vector2::new(length, 0.0),
        Vector2::new(b.dot(&c) / length, b.cross(&c).norm() / length),
    ]
}

/// Returns the singular values of the affine map from a triangle of the surface to the paper, larger first; the smaller is negative if the triangle
/// is flipped (Sander et al. 2001, section 3, for the direction from paper to surface).
fn singular_values(laid: &[Vector2<f64>; 2], flat: &[Vector2<f64>; 3]) -> [f64; 2] {
    let paper = Matrix2::from_columns(&[flat[1] - flat[0], flat[2] - flat[0]]);
    let [b, c] = laid;
    // The inverse of the upper triangular matrix with the columns b and c.
    let (x, y) = (1.0 / b.x, 1.0 / c.y);
    let map = paper * Matrix2::new(x, -c.x * x * y, 0.0, y);
    let (plus, minus) = (
        Vector2::new(map[(0, 0)] + map[(1, 1)], map[(1, 0)] - map[(0, 1)]).norm(),
        Vector2::new(map[(0, 0)] - map[(1, 1)], map[(1, 0)] + map[(0, 1)]).norm(),
    );
    [(plus + minus) / 2.0, (plus - minus) / 2.0]
}

/// Returns the stretch of these singular values: 1 if lengths are kept; infinite for a flipped triangle.
fn stretch([large, small]: [f64; 2]) -> f64 {
    if small > 0.0 {
        large.max(1.0 / small).max(1.0)
    } else {
        f64::INFINITY
    }
}
