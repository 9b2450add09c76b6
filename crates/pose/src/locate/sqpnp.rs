//! Pose from many points at once, without an initial guess (SQPnP: Terzakis & Lourakis, "A Consistently Fast and Globally Optimal Solution to the
//! Perspective-n-Point Problem", ECCV 2020).
//!
//! Substituting the best translation leaves a quadratic form in the nine entries of the rotation. The search starts at its eigenvectors of small
//! eigenvalues, as in the paper; it proceeds on the rotation manifold (Levenberg–Marquardt on the tangent space), where the paper solves quadratic
//! programs with linearised constraints. Both converge to the same minima; `tests/solvers.rs` compares with OpenCV.

use nalgebra::{Matrix3, Point3, Rotation3, SMatrix, SVector, SymmetricEigen, Vector3};

use super::planar::{nearest_rotation, square, translation};
use crate::camera::Camera;
use scaleproof_core::geometry::{Rigid, rigid};
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};

type QuadraticForm = SMatrix<f64, 9, 9>;
type Nine = SVector<f64, 9>;

const FEWEST_POINTS: usize = 3;

/// Returns the `T_camera_model` that minimises Σ (X − uZ)² + (Y − vZ)² over all points, in front of the camera. Pixels beyond the lens model's range
/// are ignored; `None` if fewer than three are left or they do not determine the pose.
pub fn sqpnp(model_mm: &[Point3<f64>], image_px: &[[f64; 2]], camera: &Camera) -> Option<Rigid> {
    let reached = model_mm.iter().zip(image_px);
    let reached = reached.filter_map(|(point, pixel)| Some((*point, camera.point_at(*pixel)?)));
    let (model, seen): (Vec<Point3<f64>>, Vec<[f64; 2]>) = reached.unzip();
    if model.len() < FEWEST_POINTS {
        return None;
    }
    // Centred and scaled, so that all numbers are near 1.
    let count = model.len() as f64;
    let mean = model.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count;
    let scale = model.iter().map(|p| (p.coords - mean).norm()).sum::<f64>() / count;
    let scaled: Vec<_> = model.iter().map(|p| Point3::from((p.coords - mean) / scale)).collect();
    let rotation = best_rotation(&scaled, &seen)?;
    let translation = translation(&rotation, &scaled, &seen)? * scale - rotation * mean;
    (translation.iter().all(|v| v.is_finite())).then(|| rigid::from_matrix(rotation, translation))
}

/// Returns the best of the minima from both signs of each eigenvector; stops when no further one can be better (section 3.3 of the paper).
fn best_rotation(model: &[Point3<f64>], seen: &[[f64; 2]]) -> Option<Matrix3<f64>> {
    let form = form(model, seen)?;
    let eigen = SymmetricEigen::try_new(form, f64::EPSILON, 1000)?;
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    let mut best: Option<(f64, Matrix3<f64>)> = None;
    for i in order {
        if best.is_some_and(|(cost, _)| cost <= 3.0 * eigen.eigenvalues[i]) {
            break;
        }
        for sign in [1.0, -1.0] {
            let start = Matrix3::from_row_iterator((sign * eigen.eigenvectors.column(i)).iter().copied());
            let found = minimum(nearest_rotation(&start), &form);
            let cost = cost(&found, &form);
            // The points are centred: the translation is the position of their mean.
            let is_in_front = || translation(&found, model, seen).is_some_and(|t| t.z > 0.0);
            if best.is_none_or(|(least, _)| cost < least) && is_in_front() {
                best = Some((cost, found));
            }
        }
    }
    best.map(|(_, rotation)| rotation)
}

/// Returns the quadratic form of a rotation's nine entries (row by row) with the translation eliminated.
fn form(model: &[Point3<f64>], seen: &[[f64; 2]]) -> Option<QuadraticForm> {
    let of_point = |p: &Point3<f64>| SMatrix::<f64, 3, 9>::from_fn(|i, j| if j / 3 == i { p[j % 3] } else { 0.0 });
    let (mut sum, mut crossed) = (Matrix3::zeros(), SMatrix::<f64, 3, 9>::zeros());
    for (point, ray) in model.iter().zip(seen) {
        let q = square(*ray);
        sum += q;
        crossed += q * of_point(point);
    }
    let follow = -sum.try_inverse()? * crossed;
    let mut form = QuadraticForm::zeros();
    for (point, ray) in model.iter().zip(seen) {
        let left = of_point(point) + follow;
        form += left.transpose() * square(*ray) * left;
    }
    form.iter().all(|v| v.is_finite()).then_some(form)
}

fn minimum(start: Matrix3<f64>, form: &QuadraticForm) -> Matrix3<f64> {
    let limits = Limits {
        first_damping: 1e-6,
        most_trials: 30,
        relative_gain: 0.0,
        absolute_gain: 0.0,
    };
    nearest_rotation(&minimise(OnRotations::at(start, form), &limits).rotation)
}

struct OnRotations<'a> {
    rotation: Matrix3<f64>,
    cost: f64,
    form: &'a QuadraticForm,
}

impl OnRotations<'_> {
    fn at(rotation: Matrix3<f64>, form: &QuadraticForm) -> OnRotations<'_> {
        let cost = cost(&rotation, form);
        OnRotations { rotation, cost, form }
    }
}

impl LeastSquares for OnRotations<'_> {
    fn cost(&self) -> f64 {
        self.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        let turned = |axis| numbers(&(Vector3::<f64>::ith_axis(axis).cross_matrix() * self.rotation));
        let jacobian = SMatrix::<f64, 9, 3>::from_columns(&[0, 1, 2].map(turned));
        let gradient = jacobian.transpose() * self.form * numbers(&self.rotation);
        let information = jacobian.transpose() * self.form * jacobian;
        let damped = information + Matrix3::identity() * (damping * (information.trace() + f64::MIN_POSITIVE));
        let step = -(damped.try_inverse()? * gradient);
        Some(OnRotations::at(
            Rotation3::new(step).into_inner() * self.rotation,
            self.form,
        ))
    }
}

fn cost(rotation: &Matrix3<f64>, form: &QuadraticForm) -> f64 {
    let r = numbers(rotation);
    r.dot(&(form * r))
}

fn numbers(m: &Matrix3<f64>) -> Nine {
    Nine::from_iterator(m.transpose().iter().copied())
}
