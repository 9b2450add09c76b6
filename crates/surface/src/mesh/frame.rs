//! Frame of a mesh file, as it lies in the model frame.

use nalgebra::{Matrix3, Point3};

/// Transform from the mesh's file to the model frame: a turn, then a shift and a scale.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FileFrame {
    pub(super) turn: Matrix3<f64>,
    pub(super) ground: Point3<f64>,
    pub(super) scale: f64,
}

impl Default for FileFrame {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            ground: Point3::origin(),
            scale: 1.0,
        }
    }
}

impl FileFrame {
    pub(super) fn to_file(&self, p: &Point3<f64>) -> Point3<f64> {
        self.turn.transpose() * (p / self.scale + self.ground.coords)
    }
}
