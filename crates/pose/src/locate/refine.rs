//! Levenberg–Marquardt refinement of a pose over the corners' reprojection errors.

use nalgebra::{Matrix6, Vector6};

use super::matches::Corners;
use crate::camera::Camera;
use scaleproof_core::geometry::{Rigid, rigid::stepped};
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};

/// Infinite Huber threshold: plain least squares.
pub(super) const NO_HUBER: f64 = f64::INFINITY;

/// Convergence limits: the last step lowers the cost by less than (1e-7 px)².
const LIMITS: Limits = Limits {
    first_damping: 1e-4,
    most_trials: 50,
    relative_gain: 0.0,
    absolute_gain: 1e-14,
};

/// Coarse convergence limits: the change by further steps, below a thousandth of the cost, is far within the noise.
const ROUGH: Limits = Limits {
    relative_gain: 1e-3,
    ..LIMITS
};

pub(super) struct CornerEquations<'a> {
    pose: Rigid,
    /// JᵀWJ by the step (ω, υ) of [`stepped`].
    pub information: Matrix6<f64>,
    gradient: Vector6<f64>,
    /// Σ 2ρ(|r|), px²: the sum of squares if no residual is longer than the threshold.
    cost: f64,
    corners: &'a Corners,
    camera: &'a Camera,
    huber_px: f64,
}

/// Returns the pose at the minimum near `start`. Residuals longer than `huber_px` count linearly instead of squared (Huber 1964). `None` if a corner
/// has no pixel at the start.
pub(super) fn refine(start: &Rigid, corners: &Corners, camera: &Camera, huber_px: f64) -> Option<Rigid> {
    let start = CornerEquations::at(*start, corners, camera, huber_px)?;
    Some(minimise(start, &LIMITS).pose)
}

/// Returns an approximate minimum near `start` and its cost (px²), for poses of which only the scatter matters. `None` if a corner has no pixel at
/// the start.
pub(super) fn refine_roughly(start: &Rigid, corners: &Corners, camera: &Camera) -> Option<(Rigid, f64)> {
    let start = CornerEquations::at(*start, corners, camera, NO_HUBER)?;
    let end = minimise(start, &ROUGH);
    Some((end.pose, end.cost))
}

impl<'a> CornerEquations<'a> {
    /// Builds the normal equations at a pose; `None` if a corner has no pixel or a number is not finite.
    pub(super) fn at(
        pose: Rigid,
        corners: &'a Corners,
        camera: &'a Camera,
        huber_px: f64,
    ) -> Option<CornerEquations<'a>> {
        let (mut information, mut gradient, mut cost) = ([[0.0; 6]; 6], [0.0; 6], 0.0);
        let turn = pose.rotation.to_rotation_matrix();
        for (point, [u, v]) in corners.model_mm.iter().zip(&corners.image_px) {
            let ([x, y], jacobian) = camera.project_by_step(&(turn * point + pose.translation.vector))?;
            let off = [x - u, y - v];
            let (weight, square) = weighed((off[0] * off[0] + off[1] * off[1]).sqrt(), huber_px);
            cost += square;
            for (row, off) in off.into_iter().enumerate() {
                let row: [f64; 6] = std::array::from_fn(|column| jacobian[(row, column)]);
                add_row(&mut information, &mut gradient, row, weight, off);
            }
        }
        cost.is_finite().then(|| CornerEquations {
            pose,
            information: Matrix6::from_fn(|i, j| information[i.max(j)][i.min(j)]),
            gradient: Vector6::from(gradient),
            cost,
            corners,
            camera,
            huber_px,
        })
    }
}

/// Returns the Huber weight of a residual, and its contribution to the cost.
fn weighed(length_px: f64, huber_px: f64) -> (f64, f64) {
    if length_px > huber_px {
        (huber_px / length_px, 2.0 * huber_px * length_px - huber_px * huber_px)
    } else {
        (1.0, length_px * length_px)
    }
}

/// Adds a row of the Jacobian to the normal equations (lower triangle only).
fn add_row(information: &mut [[f64; 6]; 6], gradient: &mut [f64; 6], row: [f64; 6], weight: f64, off: f64) {
    for i in 0..6 {
        let weighted = weight * row[i];
        gradient[i] += weighted * off;
        (0..=i).for_each(|j| information[i][j] += weighted * row[j]);
    }
}

impl LeastSquares for CornerEquations<'_> {
    fn cost(&self) -> f64 {
        self.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        let diagonal = Matrix6::from_diagonal(&self.information.diagonal());
        let damped = self.information + diagonal * damping;
        let step = -damped.cholesky()?.solve(&self.gradient);
        CornerEquations::at(stepped(&self.pose, &step), self.corners, self.camera, self.huber_px)
    }
}

/// Returns the difference of each corner's projection from its seen position, px; `None` if a corner has no pixel.
pub(super) fn residuals_px(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<Vec<[f64; 2]>> {
    let residual = |(point, [u, v]): (&nalgebra::Point3<f64>, &[f64; 2])| {
        let [x, y] = camera.project(&(pose * point))?;
        let residual = [x - u, y - v];
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    };
    corners.model_mm.iter().zip(&corners.image_px).map(residual).collect()
}

/// Returns the root mean square distance of the corners from their projections, px.
pub(super) fn rms_px(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<f64> {
    let residuals = residuals_px(pose, corners, camera)?;
    let sum: f64 = residuals.iter().flatten().map(|r| r * r).sum();
    Some((sum / residuals.len() as f64).sqrt())
}
