//! Bundle adjustment of one camera and a pose per photo, by Levenberg–Marquardt.
//!
//! Own code, for what OpenCV's `calibrateCamera` does not give: the covariance of all camera numbers together, any model of the
//! ladder, and refits without some photos. The normal equations are solved by the Schur complement over the poses
//! (Triggs et al. 2000, "Bundle Adjustment: A Modern Synthesis", section 6.1).

use nalgebra::{DMatrix, DVector, Matrix6, Point3, SMatrix, SVector, Vector2, Vector6};

use super::model::{self, ALL, LensModel};
use scaleproof_core::geometry::{Rigid, rigid::stepped};
use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::{Parameters, by_step, project_unchecked};
use scaleproof_pose::locate::{planar_branches, sqpnp};

/// Limits of a fit: a step that lowers the cost by less than this share ends it; with a thousand numbers, a thousandth of a σ.
const LIMITS: Limits = Limits {
    first_damping: 1e-3,
    most_trials: 600,
    relative_gain: 1e-9,
    absolute_gain: 0.0,
};
/// Number of the best starting focal lengths that are followed.
const FOLLOWED: usize = 2;

/// Observations of one photo: points whose places are known (mm; those of a board have z = 0), and their places in the photo (px).
#[derive(Debug, Clone)]
pub struct View {
    pub points_mm: Vec<Point3<f64>>,
    pub seen_px: Vec<[f64; 2]>,
}

impl View {
    /// Returns every other point, from `first` on.
    pub fn half(&self, first: usize) -> View {
        View {
            points_mm: self.points_mm.iter().skip(first).step_by(2).copied().collect(),
            seen_px: self.seen_px.iter().skip(first).step_by(2).copied().collect(),
        }
    }
}

/// A camera and poses that explain the views best, in least squares.
#[derive(Debug, Clone)]
pub struct CameraFit {
    pub model: LensModel,
    pub camera: Parameters,
    /// `T_camera_board`, one per view.
    pub poses: Vec<Rigid>,
    /// Sum of squared distances, px².
    pub cost: f64,
}

/// Fits a model from a start. `None` when the start has no finite residuals.
pub(super) fn fit(model: LensModel, views: &[View], camera: Parameters, poses: Vec<Rigid>) -> Option<CameraFit> {
    let start = CameraFit {
        model,
        camera,
        poses,
        cost: f64::INFINITY,
    };
    Some(minimise(CameraEquations::at(start, views)?, &LIMITS).fit)
}

/// Fits the camera that explains the views best, in least squares, with the poses free: of a model, from a start, whose other numbers stay.
/// Observations are in the frame of the camera's image. `poses`: `T_camera_points` of each view, about. `None` where the fit finds none.
pub fn refit(model: LensModel, start: &Camera, views: &[View], poses: Vec<Rigid>) -> Option<Camera> {
    let found = fit(model, views, start.parameters(), poses)?.camera;
    let mut camera = Camera::from_parameters((start.width, start.height), &found);
    camera.guess = start.guess;
    Some(camera)
}

/// Fits the pose of one view under a fixed camera, in least squares, from a start; returns it with its cost, px².
pub(super) fn pose(view: &View, camera: &Parameters, start: Rigid) -> Option<(Rigid, f64)> {
    let found = minimise(PoseEquations::at(start, view, camera)?, &LIMITS);
    Some((found.pose, found.block.cost))
}

/// Returns the best fit of a model, the smallest or the fisheye, over starting focal lengths from wide angle to telephoto.
pub(super) fn first(model: LensModel, size: (u32, u32), views: &[View]) -> Option<CameraFit> {
    // The first, for a fisheye, has 180° across.
    const BY_LONGER_SIDE: [f64; 8] = [0.32, 0.45, 0.65, 0.9, 1.3, 1.9, 2.8, 4.5];
    let longer = f64::from(size.0.max(size.1));
    let start = |share: &f64| {
        let camera = model::start(model, size, share * longer);
        let poses: Vec<Rigid> = views.iter().map(|v| best_start(v, &camera)).collect::<Option<_>>()?;
        Some((cost(views, &camera, &poses)?, camera, poses))
    };
    let shares = &BY_LONGER_SIDE[usize::from(model != LensModel::Fisheye)..];
    let mut starts: Vec<_> = shares.iter().filter_map(start).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let followed = starts.into_iter().take(FOLLOWED);
    let fits = followed.filter_map(|(_, camera, poses)| fit(model, views, camera, poses));
    fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Returns the better branch of a planar view, or the one start of another, refined. The start uses those points whose pixels the camera model can
/// unproject.
fn best_start(view: &View, camera: &Parameters) -> Option<Rigid> {
    let lens = Camera::from_parameters((1, 1), camera);
    let pairs = view.points_mm.iter().copied().zip(view.seen_px.iter().copied());
    let (points_mm, seen_px): (Vec<_>, Vec<_>) = pairs.filter(|(_, px)| lens.point_at(*px).is_some()).unzip();
    let starts = if points_mm.iter().all(|point| point.z == 0.0) {
        planar_branches(&points_mm, &seen_px, &lens)
    } else {
        sqpnp(&points_mm, &seen_px, &lens).into_iter().collect()
    };
    let refined = starts.into_iter().filter_map(|start| pose(view, camera, start));
    refined.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(pose, _)| pose)
}

impl CameraFit {
    /// Returns the root mean square residual over all corners of the views, px.
    pub(super) fn rms_px(&self, views: &[View]) -> f64 {
        let corners: usize = views.iter().map(|v| v.seen_px.len()).sum();
        (self.cost / corners as f64).sqrt()
    }

    /// Returns seen minus projected, px, of each corner of each view.
    pub fn residuals(&self, views: &[View]) -> Vec<Vec<[f64; 2]>> {
        let pairs = views.iter().zip(&self.poses);
        pairs
            .map(|(view, pose)| residuals(view, &self.camera, pose).collect())
            .collect()
    }

    /// Computes the covariance of the parameters of `model` (in its order) at this fit, the poses marginalised: the inverse of the Schur
    /// complement times the variance that the residuals show. `None` when the views do not determine the model.
    pub fn covariance(&self, model: LensModel, views: &[View]) -> Option<DMatrix<f64>> {
        let seen_as = CameraFit { model, ..self.clone() };
        let (reduced, _) = CameraEquations::at(seen_as, views)?.reduced(0.0)?;
        let numbers: usize = views.iter().map(|v| 2 * v.seen_px.len()).sum();
        let free = numbers
            .checked_sub(model.parameters() + 6 * views.len())
            .filter(|n| *n > 0)?;
        // Scaled to a unit diagonal before it is inverted: focal lengths are thousands, k3 is a hundredth.
        let scale = DVector::from_iterator(reduced.nrows(), reduced.diagonal().iter().map(|d| d.max(1e-300).sqrt()));
        let scaled = reduced.map_with_location(|r, c, v| v / (scale[r] * scale[c]));
        let variance = self.cost / free as f64;
        let inverse = scaled.cholesky()?.inverse();
        let covariance = inverse.map_with_location(|r, c, v| variance * v / (scale[r] * scale[c]));
        covariance.iter().all(|v| v.is_finite()).then_some(covariance)
    }
}

/// The normal equations of one view: camera × camera, camera × pose, pose × pose.
#[derive(Default)]
struct Block {
    camera: SMatrix<f64, ALL, ALL>,
    by_camera: SVector<f64, ALL>,
    cross: SMatrix<f64, ALL, 6>,
    pose: Matrix6<f64>,
    by_pose: Vector6<f64>,
    /// Cost, px².
    cost: f64,
}

impl Block {
    /// Computes the equations; `None` when the residuals are not finite.
    fn at(view: &View, camera: &Parameters, pose: &Rigid) -> Option<Block> {
        let mut block = Block::default();
        for (point, [u, v]) in view.points_mm.iter().zip(&view.seen_px) {
            let p = pose * point;
            let at = project_unchecked(camera, &p);
            let residual = Vector2::new(u - at.pixel[0], v - at.pixel[1]);
            let by_pose = by_step(&at.by_point, &p);
            block.camera += at.by_camera.transpose() * at.by_camera;
            block.by_camera += at.by_camera.transpose() * residual;
            block.cross += at.by_camera.transpose() * by_pose;
            block.pose += by_pose.transpose() * by_pose;
            block.by_pose += by_pose.transpose() * residual;
            block.cost += residual.norm_squared();
        }
        block.cost.is_finite().then_some(block)
    }

    fn damped_pose(&self, damping: f64) -> Matrix6<f64> {
        let mut h = self.pose;
        (0..6).for_each(|i| h[(i, i)] *= 1.0 + damping);
        h
    }
}

/// Equations of one pose under a fixed camera.
struct PoseEquations<'a> {
    pose: Rigid,
    block: Block,
    view: &'a View,
    camera: &'a Parameters,
}

impl<'a> PoseEquations<'a> {
    fn at(pose: Rigid, view: &'a View, camera: &'a Parameters) -> Option<PoseEquations<'a>> {
        Some(PoseEquations {
            pose,
            block: Block::at(view, camera, &pose)?,
            view,
            camera,
        })
    }
}

impl LeastSquares for PoseEquations<'_> {
    fn cost(&self) -> f64 {
        self.block.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        let step = self.block.damped_pose(damping).cholesky()?.solve(&self.block.by_pose);
        PoseEquations::at(stepped(&self.pose, &step), self.view, self.camera)
    }
}

/// Equations of camera and poses: the camera's part summed over the views, by the parameters of the model.
struct CameraEquations<'a> {
    fit: CameraFit,
    camera: DMatrix<f64>,
    by_camera: DVector<f64>,
    blocks: Vec<Block>,
    /// Matrix from the parameters of the model to the numbers they set.
    parameters: DMatrix<f64>,
    views: &'a [View],
}

impl<'a> CameraEquations<'a> {
    fn at(fit: CameraFit, views: &'a [View]) -> Option<CameraEquations<'a>> {
        let parameters = fit.model.parameters_to_numbers();
        let blocks = views
            .iter()
            .zip(&fit.poses)
            .map(|(view, pose)| Block::at(view, &fit.camera, pose));
        let blocks: Vec<Block> = blocks.collect::<Option<_>>()?;
        let camera: SMatrix<f64, ALL, ALL> = blocks.iter().map(|b| b.camera).sum();
        let by_camera: SVector<f64, ALL> = blocks.iter().map(|b| b.by_camera).sum();
        Some(CameraEquations {
            camera: parameters.transpose() * camera * &parameters,
            by_camera: parameters.transpose() * by_camera,
            fit: CameraFit {
                cost: blocks.iter().map(|b| b.cost).sum(),
                ..fit
            },
            blocks,
            parameters,
            views,
        })
    }

    /// Returns the Schur complement over the poses and its right-hand side, the diagonals raised by `damping`.
    fn reduced(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (mut s, mut b) = (self.camera.clone(), self.by_camera.clone());
        (0..s.nrows()).for_each(|i| s[(i, i)] *= 1.0 + damping);
        for block in &self.blocks {
            let cross = self.parameters.transpose() * block.cross;
            let through = &cross * block.damped_pose(damping).cholesky()?.inverse();
            s -= &through * cross.transpose();
            b -= through * block.by_pose;
        }
        Some((s, b))
    }
}

impl LeastSquares for CameraEquations<'_> {
    fn cost(&self) -> f64 {
        self.fit.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        let (s, b) = self.reduced(damping)?;
        let change = &self.parameters * s.cholesky()?.solve(&b);
        let mut camera = self.fit.camera;
        camera.values.iter_mut().zip(&change).for_each(|(v, step)| *v += step);
        let [fx, fy, ..] = camera.values;
        if fx <= 0.0 || fy <= 0.0 || camera.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let moved = |(pose, block): (&Rigid, &Block)| {
            let right = block.by_pose - block.cross.transpose() * &change;
            let right = Vector6::from_column_slice(right.as_slice());
            Some(stepped(pose, &block.damped_pose(damping).cholesky()?.solve(&right)))
        };
        let poses = self.fit.poses.iter().zip(&self.blocks).map(moved);
        let poses = poses.collect::<Option<_>>()?;
        let fit = CameraFit {
            camera,
            poses,
            ..self.fit
        };
        CameraEquations::at(fit, self.views)
    }
}

/// Returns seen minus projected, px, of each corner.
fn residuals(view: &View, camera: &Parameters, pose: &Rigid) -> impl Iterator<Item = [f64; 2]> {
    let residual = move |(point, seen): (&Point3<f64>, &[f64; 2])| {
        let [x, y] = project_unchecked(camera, &(pose * point)).pixel;
        [seen[0] - x, seen[1] - y]
    };
    view.points_mm.iter().zip(&view.seen_px).map(residual)
}

/// Returns the sum of squared distances of one view, px²; `None` where it is not finite.
pub(super) fn squared(view: &View, camera: &Parameters, pose: &Rigid) -> Option<f64> {
    let sum: f64 = residuals(view, camera, pose).flatten().map(|r| r * r).sum();
    sum.is_finite().then_some(sum)
}

fn cost(views: &[View], camera: &Parameters, poses: &[Rigid]) -> Option<f64> {
    views.iter().zip(poses).map(|(v, p)| squared(v, camera, p)).sum()
}
