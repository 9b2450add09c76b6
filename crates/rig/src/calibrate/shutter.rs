//! Rolling shutter: its effect on the corners in a video, and the time that the sensor takes to read a frame, estimated from the residuals of a fit.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::board_photo::{BoardPhoto, SeenCorner};
use super::fit::{self, CameraFit, View};
use super::model::ALL;

/// Usual time in which the sensors of telephones and cameras read a frame of a video, s: 5 to 30 ms, and few say it.
const READ_OUT_S: f64 = 0.02;

/// Speed of a corner in the image, px/s, by the photo's name and the corner's id.
pub type Motion = BTreeMap<(String, usize), [f64; 2]>;

/// Least standard deviation of a read-out, s: a hand turns back between frames, which makes their motions seem slower and the read-out longer. In
/// four rendered videos it was off by 0.7, 0.8, 1.3 and 3.7 ms.
const LEAST_SIGMA_S: f64 = 0.002;

/// Time that the sensor took to read a frame, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReadOut {
    pub seconds: f64,
    pub sigma_s: f64,
}

impl ReadOut {
    /// Estimates the read-out by which a fit explains its photos best. The usual one, half of [`READ_OUT_S`] to one and a half of it, weighs as much
    /// as it is known; where nothing moves, it is all that is known, and does nothing.
    pub fn of(fit: &CameraFit, views: &[View], photos: &[BoardPhoto], motion: &Motion) -> ReadOut {
        let usual = ReadOut {
            seconds: READ_OUT_S,
            sigma_s: READ_OUT_S / 2.0,
        };
        let cost = |seconds: f64| Some(refitted(fit, &still(views, photos, motion, seconds))?.cost);
        let costs = [0.0, READ_OUT_S, 2.0 * READ_OUT_S].map(cost);
        let [Some(none), Some(one), Some(two)] = costs else {
            return usual;
        };
        // The cost is a parabola, as the read-out moves corners in proportion.
        let bend = (none - 2.0 * one + two) / READ_OUT_S.powi(2);
        let slope = (4.0 * one - 3.0 * none - two) / (2.0 * READ_OUT_S);
        let least = none - slope.powi(2) / (2.0 * bend);
        let numbers: usize = views.iter().map(|view| 2 * view.seen_px.len()).sum();
        let free = numbers.saturating_sub(6 * views.len() + fit.model.parameters()).max(1);
        let variance = 2.0 * least / free as f64 / bend + LEAST_SIGMA_S.powi(2);
        if !(bend > 0.0 && variance.is_finite() && variance > 0.0) {
            return usual;
        }
        let [of_video, of_usual] = [1.0 / variance, 1.0 / usual.sigma_s.powi(2)];
        ReadOut {
            seconds: (-slope / bend * of_video + usual.seconds * of_usual) / (of_video + of_usual),
            sigma_s: 1.0 / (of_video + of_usual).sqrt(),
        }
    }

    /// Moves the corners of photos to where they were when the middle row was read.
    pub fn taken_back(self, mut photos: Vec<BoardPhoto>, motion: &Motion) -> Vec<BoardPhoto> {
        for photo in &mut photos {
            let moved = shifts(photo, motion, self.seconds);
            for (corner, [x, y]) in photo.corners.iter_mut().zip(moved) {
                corner.px = [corner.px[0] - x, corner.px[1] - y];
            }
        }
        photos
    }

    /// Adds to a covariance of the camera's parameters the change by one standard deviation of the read-out. Whoever walks round goes one way, so
    /// that the changes in frames do not cancel each other.
    pub fn raised(
        self,
        covariance: DMatrix<f64>,
        fit: &CameraFit,
        views: &[View],
        photos: &[BoardPhoto],
        motion: &Motion,
    ) -> DMatrix<f64> {
        let Some(other) = refitted(fit, &still(views, photos, motion, self.sigma_s)) else {
            return covariance;
        };
        let numbers = fit.model.parameters_to_numbers();
        let change = DVector::from_fn(covariance.nrows(), |parameter, _| {
            let number = (0..ALL).find(|number| numbers[(*number, parameter)] != 0.0);
            number.map_or(0.0, |n| other.camera.values[n] - fit.camera.values[n])
        });
        covariance + &change * change.transpose()
    }
}

fn refitted(fit: &CameraFit, views: &[View]) -> Option<CameraFit> {
    fit::fit(fit.model, views, fit.camera, fit.poses.clone())
}

/// Returns views as they would be without a read-out of `seconds`.
fn still(views: &[View], photos: &[BoardPhoto], motion: &Motion, seconds: f64) -> Vec<View> {
    let one = |(view, photo): (&View, &BoardPhoto)| {
        let corners = view.seen_px.iter().zip(shifts(photo, motion, seconds));
        View {
            seen_px: corners.map(|(px, by)| [px[0] - by[0], px[1] - by[1]]).collect(),
            ..view.clone()
        }
    };
    views.iter().zip(photos).map(one).collect()
}

/// Returns the shift of each corner of a photo by a read-out of `seconds`, px.
fn shifts(photo: &BoardPhoto, motion: &Motion, seconds: f64) -> Vec<[f64; 2]> {
    let shift = |corner: &SeenCorner| {
        let speed = motion.get(&(photo.file.clone(), corner.id)).unwrap_or(&[0.0; 2]);
        let late_s = seconds * ((corner.px[1] + 0.5) / f64::from(photo.size.1) - 0.5);
        speed.map(|speed| speed * late_s)
    };
    photo.corners.iter().map(shift).collect()
}
