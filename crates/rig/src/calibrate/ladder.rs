//! Choice of the model: the smallest whose held-out error is as good as the best.

use nalgebra::{Point3, Vector3};

use super::fit::{self, CameraFit, View};
use super::model::LensModel;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::projection::Parameters;

/// Largest number of folds; each leaves whole photos out.
const MOST_FOLDS: usize = 10;
/// Largest ratio of a chosen model's error to the best, even where its standard error would allow more.
const MOST_WORSE: f64 = 1.05;

/// A model fitted to all photos, and its held-out error.
#[derive(Debug, Clone)]
pub struct CandidateModel {
    pub model: LensModel,
    pub fit: CameraFit,
    /// Held-out error, root mean square over the photos, px.
    pub held_out_px: f64,
    /// Standard error of `held_out_px` over the photos, px.
    pub error_px: f64,
    /// Change of the poses against the chosen model.
    pub moves: ModelDifference,
}

/// Move of the camera by another model in the same photos, in the worst of them.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, schemars::JsonSchema)]
pub struct ModelDifference {
    /// The direction in which the camera stands, seen from the board's middle, degrees.
    pub direction_deg: f64,
    /// Its distance from there: mm, and per cent.
    pub distance_mm: f64,
    pub distance_percent: f64,
}

/// Fits every one of `tried` models of the ladder, each from the last but for the fisheye; a model that finds no fit, or that the photos are too few for, is left
/// out.
///
/// The held-out error of a model: it is fitted without the photos of a fold; in each of these the pose is found from every other corner
/// with the camera held, and the remaining corners are predicted from it; then the halves change roles. So no corner that is
/// judged had a part in the camera or in the pose it is judged by.
pub(super) fn fit_ladder(
    tried: &[LensModel],
    first: CameraFit,
    size: (u32, u32),
    views: &[View],
) -> Vec<CandidateModel> {
    let mut models: Vec<CandidateModel> = Vec::new();
    let mut start = Some(first);
    for model in tried.iter().copied() {
        let is_fisheye = model == LensModel::Fisheye;
        let found = if is_fisheye {
            fit::first(model, size, views)
        } else {
            start
                .take()
                .and_then(|start| fit::fit(model, views, start.camera, start.poses))
        };
        let Some((errors, fit)) = found.and_then(|fit| Some((held_out(&fit, views)?, fit))) else {
            continue;
        };
        let (held_out_px, error_px) = summary(&errors);
        if !is_fisheye {
            start = Some(fit.clone());
        }
        models.push(CandidateModel {
            model,
            fit,
            held_out_px,
            error_px,
            moves: ModelDifference::default(),
        });
    }
    models
}

/// Returns the smallest model whose held-out error is within one standard error of the best, and within 5 % of it (Breiman et al.
/// 1984's rule for trees, with a lid on it: few photos make a standard error wide).
pub(super) fn choose(models: &[CandidateModel]) -> Option<usize> {
    let best = models.iter().min_by(|a, b| a.held_out_px.total_cmp(&b.held_out_px))?;
    let limit = (best.held_out_px + best.error_px).min(MOST_WORSE * best.held_out_px);
    models.iter().position(|r| r.held_out_px <= limit)
}

/// Returns the mean squared error of each photo, px², from fits that have not seen it.
fn held_out(whole: &CameraFit, views: &[View]) -> Option<Vec<f64>> {
    let folds = views.len().min(MOST_FOLDS);
    let mut errors = vec![0.0; views.len()];
    for fold in 0..folds {
        let stays = |i: &usize| i % folds != fold;
        let kept: Vec<usize> = (0..views.len()).filter(stays).collect();
        let seen: Vec<View> = kept.iter().map(|i| views[*i].clone()).collect();
        let poses = kept.iter().map(|i| whole.poses[*i]).collect();
        let without = fit::fit(whole.model, &seen, whole.camera, poses)?;
        for i in (0..views.len()).filter(|i| !stays(i)) {
            errors[i] = cross_validated(&views[i], &without.camera, whole.poses[i])?;
        }
    }
    Some(errors)
}

fn cross_validated(view: &View, camera: &Parameters, start: Rigid) -> Option<f64> {
    let (even, odd) = (view.half(0), view.half(1));
    let mut sum = 0.0;
    for (known, judged) in [(&even, &odd), (&odd, &even)] {
        sum += fit::squared(judged, camera, &fit::pose(known, camera, start)?.0)?;
    }
    Some(sum / view.seen_px.len() as f64)
}

/// Returns the root of the mean, and its standard error (delta method: σ(√m) = σ(m) / 2√m).
fn summary(squared: &[f64]) -> (f64, f64) {
    let n = squared.len() as f64;
    let mean = squared.iter().sum::<f64>() / n;
    let variance = squared.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let root = mean.sqrt();
    (root, (variance / n).sqrt() / (2.0 * root).max(1e-12))
}

/// Computes the move of the camera by each model against the chosen one, on the photos themselves.
pub(super) fn compare(models: &mut [CandidateModel], chosen: usize, middle_mm: Point3<f64>) {
    let Some(reference) = models.get(chosen).map(|r| r.fit.poses.clone()) else {
        return;
    };
    for model in models.iter_mut() {
        let mut worst = ModelDifference::default();
        for (a, b) in reference.iter().zip(&model.fit.poses) {
            let (a, b) = (camera_from(a, middle_mm), camera_from(b, middle_mm));
            let away = (b.norm() - a.norm()).abs();
            worst.direction_deg = worst.direction_deg.max(a.angle(&b).to_degrees());
            worst.distance_mm = worst.distance_mm.max(away);
            worst.distance_percent = worst.distance_percent.max(100.0 * away / a.norm());
        }
        model.moves = worst;
    }
}

/// Returns the vector from a point to the camera, mm.
fn camera_from(pose: &Rigid, middle_mm: Point3<f64>) -> Vector3<f64> {
    pose.inverse() * Point3::origin() - middle_mm
}

/// Returns the board's normal in the camera frame, towards the camera.
pub(super) fn normal(pose: &Rigid) -> Vector3<f64> {
    let n = pose.rotation * Vector3::z();
    if n.dot(&pose.translation.vector) > 0.0 { -n } else { n }
}
