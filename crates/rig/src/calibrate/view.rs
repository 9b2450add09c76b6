//! What a fit sees of one photo, and the poses that it starts from.

use nalgebra::Point3;

use super::model::{self, ALL};
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::locate::planar_branches;

/// What a fit sees of one photo: points whose places are known (mm; those of a board have z = 0), and where the photo shows them (px).
#[derive(Debug, Clone)]
pub struct View {
    pub points_mm: Vec<Point3<f64>>,
    pub seen_px: Vec<[f64; 2]>,
}

impl View {
    /// Every other point, from `first` on.
    pub fn half(&self, first: usize) -> View {
        View {
            points_mm: self.points_mm.iter().skip(first).step_by(2).copied().collect(),
            seen_px: self.seen_px.iter().skip(first).step_by(2).copied().collect(),
        }
    }

    /// `T_camera_board` of both planar branches with a camera.
    pub fn starting_poses(&self, camera: &[f64; ALL]) -> Vec<Rigid> {
        planar_branches(&self.points_mm, &self.seen_px, &model::camera((1, 1), camera))
    }
}
