//! What a rolling shutter does to the pose of a camera that moves.
//!
//! The rows of an image are read one after the other, so that a corner is seen where it was some milliseconds before or after the middle row: at a share s of the height from
//! there, by d = J ξ s R, with the camera's motion ξ (per second), the read-out R and the derivatives J of the corner by the pose. Least squares takes part of that for a step of
//! the pose, (JᵀJ)⁻¹Jᵀd (first derivatives, as in `camera_doubt`), and the residuals do not say so: on the rendered walk of captures/walk (read-out 10 ms) the errors of
//! azimuth are these steps to a tenth of their size, and ten times what corner noise explains.

use nalgebra::{Matrix6, Point3, Vector6};

use super::{Located, Sigma};
use crate::camera::Camera;
use crate::scene::Scene;
use scaleproof_core::geometry::{Rigid, rigid::step_between};

/// How long the sensors of telephones and cameras take to read a frame of a video, s: 5 to 30 ms, and few say it. Taken as one standard deviation.
pub const READ_OUT_S: f64 = 0.02;

/// The standard deviations that a read-out of [`READ_OUT_S`] adds to the viewpoint of a frame whose camera has moved from the pose `before` in so many seconds. `camera` is
/// the one that fits the frame, which was turned clockwise by `turned_deg` to be upright. `None` where the corners leave the pose open or no time has passed.
pub fn shutter_sigma(
    located: &Located,
    (before, seconds): (&Rigid, f64),
    scene: &Scene,
    camera: &Camera,
    turned_deg: u32,
) -> Option<Sigma> {
    let motion = step_between(before, &located.pose) / seconds;
    let tags = scene.tags.iter().filter(|tag| located.tags.contains(&tag.id));
    let corners: Vec<Point3<f64>> = tags.flat_map(|tag| tag.corners_mm()).collect();
    let (mut information, mut seen_as) = (Matrix6::zeros(), Vector6::zeros());
    for corner in &corners {
        let ([x, y], by_pose) = camera.project_by_pose(&located.pose, corner)?;
        let (at, rows) = if turned_deg % 180 == 90 {
            (x, camera.width)
        } else {
            (y, camera.height)
        };
        let share = (at + 0.5) / f64::from(rows) - 0.5;
        information += by_pose.transpose() * by_pose;
        seen_as += by_pose.transpose() * (by_pose * motion) * (share * READ_OUT_S);
    }
    let step = information.cholesky()?.solve(&seen_as);
    let sigma = Sigma::new(&(step * step.transpose()), &located.pose, scene.model.target_mm());
    [sigma.azimuth_deg, sigma.pitch_deg, sigma.distance_mm]
        .iter()
        .all(|v| v.is_finite())
        .then_some(sigma)
}
