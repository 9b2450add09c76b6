//! How long the frames of a video are exposed, told by the video itself: a tag's side is blurred as far as the camera's motion moves it across itself meanwhile.
//!
//! By that and the motion of a frame it is known how far the model is smeared in it. No blur measured in the frame says so: a camera that goes round a model smears what is near and
//! hardly what is far, and each side tells of the motion across itself alone.

use nalgebra::{Matrix2, Vector2, Vector6};
use serde::{Deserialize, Serialize};

use crate::look::Look;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Located;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{EdgeBlur, SeenTag};

/// So many sides of a frame are remembered: hundreds of frames have enough.
pub const SIDES: usize = 4;
/// What is known of the exposure before a video is seen, s: 1/60, and 0 to 1/40.
const USUAL_S: f64 = 1.0 / 60.0;
/// Rounds of reweighting, and the difference (px²) below which all weigh alike.
const ROUNDS: usize = 15;
const ALIKE_PX2: f64 = 0.02;

/// One side of a tag in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// Times the motion (rad and mm per second): how fast it moves across itself, px/s.
    across: [f32; 6],
    /// The variance of its blur, px².
    variance: f32,
}

impl Side {
    /// Some sides of a frame's tags, spread over those whose blur is known, others for each `turn`; `camera` is the one that fits the frame.
    pub fn some(
        turn: u64,
        blurs: &[EdgeBlur],
        seen: &[SeenTag],
        located: &Located,
        scene: &Scene,
        camera: &Camera,
    ) -> [Option<Side>; SIDES] {
        let side = |edge: &EdgeBlur| {
            let seen = seen.get(edge.tag)?;
            let tag = scene
                .tags
                .iter()
                .find(|tag| (tag.family, tag.id) == (seen.family, seen.id))?;
            let corners = tag.corners_mm();
            let middle = nalgebra::center(&corners[edge.side % 4], &corners[(edge.side + 1) % 4]);
            let (_, by_pose) = camera.project_by_pose(&located.pose, &middle)?;
            let across = by_pose.transpose() * Vector2::from(edge.normal);
            Some(Side {
                across: across.map(|v| v as f32).into(),
                variance: edge.px.powi(2) as f32,
            })
        };
        let known: Vec<Side> = blurs
            .iter()
            .filter(|edge| edge.px.is_finite())
            .filter_map(side)
            .collect();
        let step = known.len().div_ceil(SIDES).max(1);
        let first = (turn % step as u64) as usize;
        std::array::from_fn(|place| known.get(first + place * step).copied())
    }

    /// The variance of its blur, and that of the blur in an exposure of a second: a uniform line of length L has the variance L²/12.
    fn told(&self, per_s: &Vector6<f64>) -> [f64; 2] {
        let speed = Vector6::from(self.across.map(f64::from)).dot(per_s);
        [f64::from(self.variance), speed.powi(2) / 12.0]
    }
}

/// The exposure of the frames of a video whose motion is set, s, as far as their sides tell it, else as is usual.
///
/// Convolution adds variances: that of a side's blur is what the lens leaves, and the square of the exposure times that of a second. The sum of absolute differences is minimised, as some
/// sides lie in shadow. In four rendered videos it was found longer than it was by a ninth to a sixth, so that frames are rather called smeared than sharp.
pub fn exposure_s(looks: &[Look]) -> f64 {
    let views = looks.iter().filter_map(|look| look.shows.as_ref().ok());
    let moved = views.filter_map(|view| Some((view, view.motion?.per_s)));
    let told = moved.flat_map(|(view, per_s)| view.sides.into_iter().flatten().map(move |side| side.told(&per_s)));
    let usual = USUAL_S.powi(2);
    let of_usual = 1.0 / usual.powi(2);
    let square = match slope(&told.collect::<Vec<_>>()) {
        Some((square, variance)) => {
            let of_video = 1.0 / variance.max(f64::MIN_POSITIVE);
            (square * of_video + usual * of_usual) / (of_video + of_usual)
        }
        None => usual,
    };
    square.max(0.0).sqrt()
}

/// The slope of the line through points (y, x), and its variance by their own scatter; `None` where they leave it open.
fn slope(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    let mut line = Vector2::zeros();
    let mut weights = vec![1.0; points.len()];
    let mut inverse = Matrix2::zeros();
    let mut scatter = Matrix2::zeros();
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for ([y, x], weight) in points.iter().zip(&weights) {
            let row = Vector2::new(1.0, *x);
            normal += *weight * row * row.transpose();
            right += *weight * *y * row;
        }
        inverse = normal.try_inverse()?;
        line = inverse * right;
        scatter = Matrix2::zeros();
        for ([y, x], weight) in points.iter().zip(&mut weights) {
            let row = Vector2::new(1.0, *x);
            let off = y - row.dot(&line);
            *weight = 1.0 / off.abs().max(ALIKE_PX2);
            scatter += (*weight * off).powi(2) * row * row.transpose();
        }
    }
    let variance = (inverse * scatter * inverse)[(1, 1)];
    (line[1].is_finite() && variance.is_finite()).then_some((line[1], variance))
}
