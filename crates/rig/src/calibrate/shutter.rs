//! What a rolling shutter may have done to a camera that comes from a video.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::BoardPhoto;
use super::fit::{self, CameraFit, View};
use super::model::ALL;
use scaleproof_pose::locate::READ_OUT_S;

/// How fast a corner moves in the image, px/s, by the photo's name and the corner's id.
pub type Motion = BTreeMap<(String, usize), [f64; 2]>;

/// A covariance of the camera's parameters with what a read-out of [`READ_OUT_S`] may have changed, as one standard deviation: the parameters are fitted again to the corners
/// where the middle row's moment has them. Whoever walks round goes one way, so that frames do not cancel each other's part. Without motion nothing is added.
pub(super) fn raised(
    covariance: DMatrix<f64>,
    fit: &CameraFit,
    views: &[View],
    photos: &[BoardPhoto],
    motion: &Motion,
) -> DMatrix<f64> {
    if motion.is_empty() {
        return covariance;
    }
    let still = |(view, photo): (&View, &BoardPhoto)| {
        let corners = photo.corners.iter().map(|corner| {
            let speed = motion.get(&(photo.file.clone(), corner.id)).unwrap_or(&[0.0; 2]);
            let late_s = READ_OUT_S * ((corner.px[1] + 0.5) / f64::from(photo.size.1) - 0.5);
            [0, 1].map(|axis| corner.px[axis] - speed[axis] * late_s)
        });
        View {
            seen_px: corners.collect(),
            ..view.clone()
        }
    };
    let stills: Vec<View> = views.iter().zip(photos).map(still).collect();
    let Some(other) = fit::fit(fit.model, &stills, fit.camera, fit.poses.clone()) else {
        return covariance;
    };
    let numbers = fit.model.parameters_to_numbers();
    let change = DVector::from_fn(covariance.nrows(), |parameter, _| {
        let number = (0..ALL).find(|number| numbers[(*number, parameter)] != 0.0);
        number.map_or(0.0, |n| other.camera.values[n] - fit.camera.values[n])
    });
    covariance + &change * change.transpose()
}
