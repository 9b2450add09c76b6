//! Bundle adjustment of one camera and a pose per photo, by Levenberg–Marquardt.
//!
//! Own code, for what OpenCV's `calibrateCamera` does not give: the covariance of all camera numbers together, any model of the
//! ladder, and refits without some photos. The normal equations are solved by the Schur complement over the poses
//! (Triggs et al. 2000, "Bundle Adjustment: A Modern Synthesis", section 6.1); projection and derivatives are OpenCV's.

use nalgebra::{DMatrix, DVector, Matrix6, Vector6};

use super::model::{self, ALL, LensModel};
use super::project::{BoardView, Pose, project, starting_poses};

const STEPS: usize = 60;
/// A step that lowers the cost by less than this share ends a fit: with a thousand numbers, a thousandth of a σ.
const SETTLED: f64 = 1e-9;
/// So many of the best starting focal lengths are followed.
const FOLLOWED: usize = 2;

/// A camera and poses that explain the views best, in least squares.
#[derive(Debug, Clone)]
pub struct CameraFit {
    pub model: LensModel,
    /// fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6.
    pub camera: [f64; ALL],
    /// One per view.
    pub poses: Vec<Pose>,
    /// Sum of squared distances, px².
    pub cost: f64,
}

/// Fits a model from a start. `None` when no step leads anywhere finite.
pub fn fit(model: LensModel, views: &[BoardView], camera: [f64; ALL], poses: Vec<Pose>) -> Option<CameraFit> {
    let cost = cost(views, &camera, &poses)?;
    let mut best = CameraFit {
        model,
        camera,
        poses,
        cost,
    };
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let normal = BlockNormalEquations::of(&best, views)?;
        let Some(next) = improved(&best, &normal, views, &mut damping) else {
            break;
        };
        let gain = (best.cost - next.cost) / best.cost.max(1e-30);
        best = next;
        if gain < SETTLED {
            break;
        }
    }
    Some(best)
}

/// The pose of one view under a camera that is held, in least squares, from a start.
pub fn pose(view: &BoardView, camera: &[f64; ALL], start: Pose) -> Option<Pose> {
    let mut pose = start;
    let mut at = squared(view, camera, &pose)?;
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let (projected, residuals) = residuals(view, camera, &pose)?;
        let j = &projected.by_pose;
        let (h, g) = (j.transpose() * j, j.transpose() * residuals);
        let mut found = None;
        while found.is_none() && damping < 1e9 {
            let mut damped = h.clone();
            (0..6).for_each(|i| damped[(i, i)] *= 1.0 + damping);
            let step = damped.cholesky()?.solve(&g);
            let next: Pose = std::array::from_fn(|i| pose[i] + step[i]);
            found = squared(view, camera, &next).filter(|c| *c < at).map(|c| (next, c));
            damping = if found.is_some() {
                damping / 10.0
            } else {
                damping * 10.0
            };
        }
        let Some((next, cost)) = found else { break };
        let gain = (at - cost) / at.max(1e-30);
        (pose, at) = (next, cost);
        if gain < SETTLED {
            break;
        }
    }
    Some(pose)
}

/// The best fit of the smallest model over starting focal lengths from wide angle to telephoto.
pub fn first(size: (u32, u32), views: &[BoardView]) -> Option<CameraFit> {
    const BY_LONGER_SIDE: [f64; 7] = [0.45, 0.65, 0.9, 1.3, 1.9, 2.8, 4.5];
    let longer = f64::from(size.0.max(size.1));
    let start = |share: &f64| {
        let camera = model::start(size, share * longer);
        let poses: Vec<Pose> = views.iter().map(|v| best_start(v, &camera)).collect::<Option<_>>()?;
        Some((cost(views, &camera, &poses)?, camera, poses))
    };
    let mut starts: Vec<_> = BY_LONGER_SIDE.iter().filter_map(start).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts
        .into_iter()
        .take(FOLLOWED)
        .filter_map(|(_, camera, poses)| fit(LensModel::F, views, camera, poses))
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// The better branch of a planar view, refined.
pub fn best_start(view: &BoardView, camera: &[f64; ALL]) -> Option<Pose> {
    starting_poses(view, camera)
        .into_iter()
        .filter_map(|start| {
            let refined = pose(view, camera, start)?;
            Some((squared(view, camera, &refined)?, refined))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, pose)| pose)
}

impl CameraFit {
    /// Seen minus projected, px, of each corner of each view.
    pub fn residuals(&self, views: &[BoardView]) -> Vec<Vec<[f64; 2]>> {
        views
            .iter()
            .zip(&self.poses)
            .map(|(view, pose)| {
                let all = residuals(view, &self.camera, pose).map(|(_, r)| r);
                all.map_or_else(Vec::new, |r| r.as_slice().chunks(2).map(|p| [p[0], p[1]]).collect())
            })
            .collect()
    }

    /// Covariance of the parameters of `model` (in its order) at this fit, the poses marginalised: the inverse of the Schur
    /// complement times the variance that the residuals show. `None` when the views do not determine the model.
    pub fn covariance(&self, model: LensModel, views: &[BoardView]) -> Option<DMatrix<f64>> {
        let seen_as = CameraFit { model, ..self.clone() };
        let normal = BlockNormalEquations::of(&seen_as, views)?;
        let (reduced, _) = normal.reduced(0.0)?;
        let numbers: usize = views.iter().map(|v| 2 * v.seen_px.len()).sum();
        let free = numbers
            .checked_sub(model.parameters() + 6 * views.len())
            .filter(|n| *n > 0)?;
        // Scaled to a unit diagonal before it is inverted: focal lengths are thousands, k3 is a hundredth.
        let scale = DVector::from_iterator(reduced.nrows(), reduced.diagonal().iter().map(|d| d.max(1e-300).sqrt()));
        let scaled = DMatrix::from_fn(reduced.nrows(), reduced.ncols(), |r, c| {
            reduced[(r, c)] / (scale[r] * scale[c])
        });
        let inverse = scaled.cholesky()?.inverse();
        let variance = self.cost / free as f64;
        let covariance = DMatrix::from_fn(reduced.nrows(), reduced.ncols(), |r, c| {
            variance * inverse[(r, c)] / (scale[r] * scale[c])
        });
        covariance.iter().all(|v| v.is_finite()).then_some(covariance)
    }
}

/// The normal equations in blocks: camera × camera, camera × pose, pose × pose.
struct BlockNormalEquations {
    camera: DMatrix<f64>,
    by_camera: DVector<f64>,
    views: Vec<ViewBlock>,
}

struct ViewBlock {
    cross: DMatrix<f64>,
    pose: Matrix6<f64>,
    by_pose: Vector6<f64>,
}

impl BlockNormalEquations {
    fn of(at: &CameraFit, views: &[BoardView]) -> Option<BlockNormalEquations> {
        let parameters = at.model.parameters();
        let mut normal = BlockNormalEquations {
            camera: DMatrix::zeros(parameters, parameters),
            by_camera: DVector::zeros(parameters),
            views: Vec::with_capacity(views.len()),
        };
        for (view, pose) in views.iter().zip(&at.poses) {
            let (projected, residuals) = residuals(view, &at.camera, pose)?;
            let (j, k) = (gathered(at.model, &projected.by_camera), &projected.by_pose);
            normal.camera += j.transpose() * &j;
            normal.by_camera += j.transpose() * &residuals;
            let (h, g) = (k.transpose() * k, k.transpose() * &residuals);
            normal.views.push(ViewBlock {
                cross: j.transpose() * k,
                pose: Matrix6::from_fn(|r, c| h[(r, c)]),
                by_pose: Vector6::from_fn(|r, _| g[r]),
            });
        }
        Some(normal)
    }

    /// The Schur complement over the poses and its right-hand side, the diagonals raised by `damping` (Marquardt 1963).
    fn reduced(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut s, mut b) = (self.camera.clone(), self.by_camera.clone());
        (0..s.nrows()).for_each(|i| s[(i, i)] *= 1.0 + damping);
        for view in &self.views {
            let through = &view.cross * view.damped_inverse(damping)?;
            s -= &through * view.cross.transpose();
            b -= &through * view.by_pose;
        }
        Some((s, b))
    }
}

impl ViewBlock {
    fn damped_inverse(&self, damping: f64) -> Option<Matrix6<f64>> {
        let mut h = self.pose;
        (0..6).for_each(|i| h[(i, i)] *= 1.0 + damping);
        Some(h.cholesky()?.inverse())
    }
}

/// One accepted step, or `None` when no damping gives a smaller cost.
fn improved(
    at: &CameraFit,
    normal: &BlockNormalEquations,
    views: &[BoardView],
    damping: &mut f64,
) -> Option<CameraFit> {
    while *damping < 1e9 {
        let next = stepped(at, normal, *damping).and_then(|(camera, poses)| {
            let cost = cost(views, &camera, &poses)?;
            (cost < at.cost).then_some(CameraFit {
                model: at.model,
                camera,
                poses,
                cost,
            })
        });
        if next.is_some() {
            *damping = (*damping / 10.0).max(1e-12);
            return next;
        }
        *damping *= 10.0;
    }
    None
}

fn stepped(at: &CameraFit, normal: &BlockNormalEquations, damping: f64) -> Option<([f64; ALL], Vec<Pose>)> {
    let (s, b) = normal.reduced(damping)?;
    let step = s.cholesky()?.solve(&b);
    let mut camera = at.camera;
    for (slots, change) in at.model.slots().iter().zip(step.iter()) {
        slots.iter().for_each(|slot| camera[*slot] += change);
    }
    if camera[0] <= 0.0 || camera[1] <= 0.0 || camera.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let poses: Option<Vec<Pose>> = at
        .poses
        .iter()
        .zip(&normal.views)
        .map(|(pose, view)| {
            let right = view.by_pose - to_vector6(&(view.cross.transpose() * &step));
            let change = view.damped_inverse(damping)? * right;
            Some(std::array::from_fn(|i| pose[i] + change[i]))
        })
        .collect();
    Some((camera, poses?))
}

fn to_vector6(v: &DVector<f64>) -> Vector6<f64> {
    Vector6::from_fn(|r, _| v[r])
}

/// The derivatives by the parameters of a model: the sum over the numbers each parameter sets.
pub(super) fn gathered(model: LensModel, by_camera: &DMatrix<f64>) -> DMatrix<f64> {
    let slots = model.slots();
    DMatrix::from_fn(by_camera.nrows(), slots.len(), |r, p| {
        slots[p].iter().map(|slot| by_camera[(r, *slot)]).sum()
    })
}

fn residuals(view: &BoardView, camera: &[f64; ALL], pose: &Pose) -> Option<(super::project::Projected, DVector<f64>)> {
    let projected = project(&view.board_mm, camera, pose)?;
    let seen = view.seen_px.iter().flatten();
    let residuals = DVector::from_iterator(projected.px.len(), seen.zip(&projected.px).map(|(s, p)| s - p));
    Some((projected, residuals))
}

/// Sum of squared distances of one view, px².
pub fn squared(view: &BoardView, camera: &[f64; ALL], pose: &Pose) -> Option<f64> {
    let sum = residuals(view, camera, pose)?.1.norm_squared();
    sum.is_finite().then_some(sum)
}

fn cost(views: &[BoardView], camera: &[f64; ALL], poses: &[Pose]) -> Option<f64> {
    views.iter().zip(poses).map(|(v, p)| squared(v, camera, p)).sum()
}
