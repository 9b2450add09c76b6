//! Levenberg–Marquardt over corners: the pose that leaves them nearest to where they were seen.

use nalgebra::{Matrix6, Vector6};

use super::matches::Corners;
use super::reprojection::{pixel_by_pose, stepped};
use crate::camera::Camera;
use crate::geometry::Rigid;

/// The normal equations of all corners at one pose.
pub(super) struct NormalEquations {
    /// JᵀWJ by (ω, υ) of [`stepped`].
    pub information: Matrix6<f64>,
    /// JᵀWr.
    gradient: Vector6<f64>,
    /// Σ 2ρ(|r|), px²: the sum of squares as long as no residual is longer than the Huber threshold.
    cost: f64,
}

/// A Huber threshold that no residual reaches: plain least squares.
pub(super) const NO_HUBER_THRESHOLD: f64 = f64::INFINITY;

const MAX_ROUNDS: usize = 50;
/// The step tolerance: steps that move all corners together by less than this end the iteration, px².
const STEP_TOLERANCE_PX2: f64 = 1e-14;

/// The pose at the minimum near `start`. Residuals longer than `huber_px` count linearly instead of squared (Huber 1964).
/// `None` when a corner has no pixel at the start, or when the corners leave the pose open.
pub(super) fn refine(start: &Rigid, corners: &Corners, camera: &Camera, huber_px: f64) -> Option<Rigid> {
    let mut pose = *start;
    let mut normal = normal_equations(&pose, corners, camera, huber_px)?;
    let mut damping = 1e-4;
    for _ in 0..MAX_ROUNDS {
        let diagonal = Matrix6::from_diagonal(&normal.information.diagonal());
        let step = -(normal.information + diagonal * damping)
            .cholesky()?
            .solve(&normal.gradient);
        let next = stepped(&pose, &step);
        match normal_equations(&next, corners, camera, huber_px).filter(|n| n.cost <= normal.cost) {
            Some(better) => {
                let moved_px2 = step.dot(&(normal.information * step));
                (pose, normal) = (next, better);
                damping = (damping / 10.0).max(1e-12);
                if moved_px2 < STEP_TOLERANCE_PX2 {
                    break;
                }
            }
            None => damping *= 10.0,
        }
        if damping > 1e8 {
            break;
        }
    }
    Some(pose)
}

/// `None` when a corner has no pixel or a number is not finite.
pub(super) fn normal_equations(
    pose: &Rigid,
    corners: &Corners,
    camera: &Camera,
    huber_px: f64,
) -> Option<NormalEquations> {
    let (mut information, mut gradient, mut cost) = (Matrix6::zeros(), Vector6::zeros(), 0.0);
    for (point, [u, v]) in corners.model_mm.iter().zip(&corners.image_px) {
        let ([x, y], jacobian) = pixel_by_pose(camera, pose, point)?;
        let residual = nalgebra::Vector2::new(x - u, y - v);
        let length = residual.norm();
        let is_beyond = length > huber_px;
        let weight = if is_beyond { huber_px / length } else { 1.0 };
        information += weight * jacobian.transpose() * jacobian;
        gradient += weight * jacobian.transpose() * residual;
        cost += if is_beyond {
            2.0 * huber_px * length - huber_px * huber_px
        } else {
            length * length
        };
    }
    cost.is_finite().then_some(NormalEquations {
        information,
        gradient,
        cost,
    })
}

/// Distance between each seen corner and its projection, px; `None` when a corner has no pixel.
pub(super) fn residuals_px(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<Vec<[f64; 2]>> {
    let of = |(point, [u, v]): (&nalgebra::Point3<f64>, &[f64; 2])| {
        let [x, y] = camera.project(&(pose * point))?;
        let residual = [x - u, y - v];
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    };
    corners.model_mm.iter().zip(&corners.image_px).map(of).collect()
}

/// Root mean square distance of corners from where they were seen, px.
pub(super) fn rms_px(pose: &Rigid, corners: &Corners, camera: &Camera) -> Option<f64> {
    let residuals = residuals_px(pose, corners, camera)?;
    let sum: f64 = residuals.iter().flatten().map(|r| r * r).sum();
    Some((sum / residuals.len() as f64).sqrt())
}
