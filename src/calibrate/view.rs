//! What a fit sees of one photo, and the poses that it starts from.

use nalgebra::Point3;

use super::model::{self, ALL};
use crate::geometry::Rigid;
use crate::locate::planar_branches;

/// What a fit sees of one photo: corners on the board (mm), and in the photo (px).
#[derive(Debug, Clone)]
pub struct BoardView {
    pub board_mm: Vec<[f64; 2]>,
    pub seen_px: Vec<[f64; 2]>,
}

impl BoardView {
    /// Every other corner, from `first` on.
    pub fn half(&self, first: usize) -> BoardView {
        let half = |list: &[[f64; 2]]| list.iter().skip(first).step_by(2).copied().collect();
        BoardView {
            board_mm: half(&self.board_mm),
            seen_px: half(&self.seen_px),
        }
    }

    /// The corners in the board frame, mm.
    pub fn points(&self) -> impl Iterator<Item = Point3<f64>> {
        self.board_mm.iter().map(|[x, y]| Point3::new(*x, *y, 0.0))
    }

    /// `T_camera_board` of both planar branches with a camera.
    pub fn starting_poses(&self, camera: &[f64; ALL]) -> Vec<Rigid> {
        let points: Vec<_> = self.points().collect();
        planar_branches(&points, &self.seen_px, &model::camera((1, 1), camera))
    }
}
