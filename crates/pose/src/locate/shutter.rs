//! What a rolling shutter does to the pose of a camera that moves.
//!
//! The rows of an image are read one after the other, so that a corner is seen where it was some milliseconds before or after the middle row: at a share s of the height from
//! there, by d = R s J ξ, with the camera's motion ξ (per second), the read-out R and the derivatives J of the corner by the pose. Least squares takes part of that for a step of
//! the pose, R (JᵀJ)⁻¹JᵀSJ ξ (first derivatives, as in `camera_doubt`), and leaves the rest in the residuals, from which the read-out of a whole video can be told.

use nalgebra::{Matrix2x6, Matrix6, Point3, Vector6};
use serde::{Deserialize, Serialize};

use super::{Located, Sigma};
use crate::camera::Camera;
use crate::scene::Scene;
use crate::tags::SeenTag;
use scaleproof_core::geometry::Rigid;

/// How long the sensors of telephones and cameras take to read a frame of a video, s: 5 to 30 ms, and few say it. Taken as one standard deviation.
pub const READ_OUT_S: f64 = 0.02;

/// How the pose found in one frame answers a motion of its camera. As arrays, for those who store it; rounded, since it is multiplied by what is known to some percent.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ShutterResponse {
    /// Times the motion (rad and mm per second): the step of the pose for each second of read-out.
    step: [[f32; 6]; 6],
    /// Times the motion: the product of the residuals with what a read-out of a second leaves in them, px².
    told: [f32; 6],
    /// From both sides times the motion: the square of what a read-out of a second leaves in the residuals, px².
    telling: [[f32; 6]; 6],
    /// From both sides times the motion: the mean square of the speed of the corners of the model's box in the image, (px/s)².
    flow: [[f32; 6]; 6],
}

impl ShutterResponse {
    /// That of a frame whose tags were seen so; `camera` is the one that fits the frame, which was turned clockwise by `turned_deg` to be upright. `None` where the corners leave
    /// the pose open.
    pub fn new(
        located: &Located,
        seen: &[SeenTag],
        scene: &Scene,
        camera: &Camera,
        turned_deg: u32,
    ) -> Option<ShutterResponse> {
        // JᵀJ, JᵀSJ, JᵀS²J, Jᵀr and JᵀSr.
        let (mut plain, mut late, mut later) = (Matrix6::zeros(), Matrix6::zeros(), Matrix6::zeros());
        let (mut left, mut left_late) = (Vector6::zeros(), Vector6::zeros());
        for (corner, px) in corners(located, seen, scene) {
            let (at, by_pose) = camera.project_by_pose(&located.pose, &corner)?;
            let share = share(px, camera, turned_deg);
            let square = by_pose.transpose() * by_pose;
            let residual = by_pose.transpose() * nalgebra::Vector2::new(px[0] - at[0], px[1] - at[1]);
            plain += square;
            late += square * share;
            later += square * share * share;
            left += residual;
            left_late += residual * share;
        }
        let solved = plain.cholesky()?;
        let step = solved.solve(&late);
        let told = left_late - late * solved.solve(&left);
        let telling = later - late * step;
        let all = step.iter().chain(told.iter()).chain(telling.iter());
        all.clone().all(|v| v.is_finite()).then(|| ShutterResponse {
            step: rounded(&step),
            told: told.map(|v| v as f32).into(),
            telling: rounded(&telling),
            flow: rounded(&flow(located, scene, camera)),
        })
    }

    /// The step by which the pose is off for each second of read-out, by a motion (rad and mm per second).
    pub fn step(&self, motion: &Vector6<f64>) -> Vector6<f64> {
        whole(&self.step) * motion
    }

    /// What the frame says of the read-out, by its motion: g and h, of which g/h is the read-out, s, and h (px² for a second) how much it weighs.
    pub fn says(&self, motion: &Vector6<f64>) -> [f64; 2] {
        let told = Vector6::from(self.told.map(f64::from));
        [told.dot(motion), motion.dot(&(whole(&self.telling) * motion))]
    }

    /// The speed of the model in the image, px/s: root mean square over the corners of its box.
    pub fn speed_px_s(&self, motion: &Vector6<f64>) -> f64 {
        motion.dot(&(whole(&self.flow) * motion)).max(0.0).sqrt()
    }
}

/// The viewpoint's standard deviations by those of a step of the pose: one column for each independent error.
pub fn step_sigma(errors: &[Vector6<f64>], pose: &Rigid, scene: &Scene) -> Sigma {
    let covariance: Matrix6<f64> = errors.iter().map(|error| error * error.transpose()).sum();
    Sigma::new(&covariance, pose, scene.model.target_mm())
}

/// The corners that the pose rests on, with where they were seen.
fn corners<'a>(
    located: &'a Located,
    seen: &'a [SeenTag],
    scene: &'a Scene,
) -> impl Iterator<Item = (Point3<f64>, [f64; 2])> + 'a {
    let tags = scene.tags.iter().filter(|tag| located.tags.contains(&tag.id));
    tags.filter_map(|tag| Some((tag, seen.iter().find(|s| (s.family, s.id) == (tag.family, tag.id))?)))
        .flat_map(|(tag, seen)| tag.corners_mm().into_iter().zip(seen.corners_px))
}

/// How much later than the middle row a pixel was read, as a share of the read-out: the sensor's rows are the upright image's from above, from the right, from below or from the left.
fn share([x, y]: [f64; 2], camera: &Camera, turned_deg: u32) -> f64 {
    let [across, down] = [(x, camera.width), (y, camera.height)].map(|(at, size)| (at + 0.5) / f64::from(size) - 0.5);
    match turned_deg % 360 {
        90 => -across,
        180 => -down,
        270 => across,
        _ => down,
    }
}

fn flow(located: &Located, scene: &Scene, camera: &Camera) -> Matrix6<f64> {
    let box_corners = scene.model.box_corners_mm();
    let seen = box_corners
        .iter()
        .filter_map(|corner| camera.project_by_pose(&located.pose, corner));
    let (mut sum, mut count) = (Matrix6::zeros(), 0.0);
    for (_, by_pose) in seen {
        let by_pose: Matrix2x6<f64> = by_pose;
        sum += by_pose.transpose() * by_pose;
        count += 1.0;
    }
    if count > 0.0 { sum / count } else { sum }
}

fn rounded(matrix: &Matrix6<f64>) -> [[f32; 6]; 6] {
    matrix.map(|v| v as f32).into()
}

fn whole(matrix: &[[f32; 6]; 6]) -> Matrix6<f64> {
    Matrix6::from(*matrix).map(f64::from)
}
