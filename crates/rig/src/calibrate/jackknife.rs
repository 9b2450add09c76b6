//! Uncertainty of a camera by fits without some photos (jackknife).

use nalgebra::{DMatrix, DVector};

use super::fit::{self, CameraFit, View};
use super::model::ALL;

/// Largest number of groups of photos that are left out in turn.
const MOST_GROUPS: usize = 20;
/// Number of groups of a film: frames that follow each other err alike, and stay together (the jackknife of blocks: Künsch 1989, "The Jackknife and
/// the Bootstrap for General Stationary Observations").
const FILM_GROUPS: usize = 8;

/// Raises a covariance of the camera's parameters to what the photos bear out.
///
/// The scatter of the corners alone understates it where the corners of one photo are off together: autofocus changes the focal length from photo to
/// photo, and paper bends. So each parameter's standard deviation is at least the jackknife's over the photos, σ² = (g − 1)/g · Σ (θᵢ − θ̄)²
/// with θᵢ fitted without the i-th of g groups of photos (Efron & Tibshirani 1993, "An Introduction to the Bootstrap", section 11.5).
/// The correlations stay. The second value is the largest factor by which a focal length's standard deviation was raised.
pub(super) fn raised(covariance: DMatrix<f64>, fit: &CameraFit, views: &[View], is_film: bool) -> (DMatrix<f64>, f64) {
    let Some(variances) = variances(fit, views, is_film) else {
        return (covariance, 1.0);
    };
    let numbers = fit.model.parameters_to_numbers();
    let factor = |parameter: usize| {
        let set_by = (0..ALL).filter(|number| numbers[(*number, parameter)] != 0.0);
        let variance = set_by.map(|number| variances[number]).fold(0.0, f64::max);
        (variance / covariance[(parameter, parameter)]).sqrt().max(1.0)
    };
    let factors = DVector::from_fn(covariance.nrows(), |parameter, _| factor(parameter));
    let is_focal = |parameter: &usize| (0..2).any(|number| numbers[(number, *parameter)] != 0.0);
    let focal = (0..factors.len())
        .filter(is_focal)
        .map(|p| factors[p])
        .fold(1.0, f64::max);
    (covariance.component_mul(&(&factors * factors.transpose())), focal)
}

/// Error that a corner in a film shares with other frames, px: the effect of light, blur, compression and motion depends on how it is seen, and frame
/// after frame shows much the same picture. In two rendered walks flat and standing tags of one size err by 0.01 to 0.09 px on average.
const ALIKE_PX: f64 = 0.05;

/// Returns the covariance of the camera's parameters by the error that the corners of all frames of a film may share; `scatter`: by the corners'
/// scatter, which many frames make small.
pub(super) fn alike(scatter: &DMatrix<f64>, fit: &CameraFit, views: &[View]) -> DMatrix<f64> {
    let numbers: usize = views.iter().map(|view| 2 * view.seen_px.len()).sum();
    let variance = fit.cost / numbers.max(1) as f64;
    scatter * (ALIKE_PX.powi(2) * views.len() as f64 / variance.max(f64::MIN_POSITIVE))
}

/// Returns the jackknife's variances of the camera's numbers; `None` where a fit without some photos fails.
fn variances(fit: &CameraFit, views: &[View], is_film: bool) -> Option<[f64; ALL]> {
    let groups = views.len().min(if is_film { FILM_GROUPS } else { MOST_GROUPS });
    let group_of = |i: usize| if is_film { i * groups / views.len() } else { i % groups };
    let without = |group: usize| {
        let kept = views
            .iter()
            .zip(&fit.poses)
            .enumerate()
            .filter(|(i, _)| group_of(*i) != group);
        let (views, poses): (Vec<View>, Vec<_>) = kept.map(|(_, (view, pose))| (view.clone(), *pose)).unzip();
        Some(fit::fit(fit.model, &views, fit.camera, poses)?.camera.values)
    };
    let cameras: Vec<[f64; ALL]> = (0..groups).map(without).collect::<Option<_>>()?;
    let n = groups as f64;
    Some(std::array::from_fn(|number| {
        let mean = cameras.iter().map(|camera| camera[number]).sum::<f64>() / n;
        let squared = cameras.iter().map(|camera| (camera[number] - mean).powi(2));
        squared.sum::<f64>() * (n - 1.0) / n
    }))
}
