//! What a tag's side tells of the exposure: its blur, and how the camera's motion moves it across itself.

use nalgebra::{Vector2, Vector6};
use serde::{Deserialize, Serialize};

use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::Located;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{EdgeBlur, SeenTag};

/// So many sides of a frame are remembered: hundreds of frames have enough.
pub const SIDES: usize = 4;

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
            let tag = scene.tag(seen.family, seen.id)?;
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
    pub(crate) fn told(&self, per_s: &Vector6<f64>) -> [f64; 2] {
        let speed = Vector6::from(self.across.map(f64::from)).dot(per_s);
        [f64::from(self.variance), speed.powi(2) / 12.0]
    }
}
