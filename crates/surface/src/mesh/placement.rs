//! Placement of a mesh: from a file's frame and unit into the model frame.

use std::path::Path;

use nalgebra::{Matrix3, Point3};

use super::error::MeshError;
use super::frame::FileFrame;
use super::triangles::Mesh;
use scaleproof_core::geometry::SignedAxis;
use scaleproof_core::geometry::length::is_size;

/// Least length of a mesh in its file: nothing is so short in any unit, and scaling it up would leave the range of numbers.
const LEAST_LENGTH: f64 = 1e-9;

pub fn is_gltf(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"))
}

/// Placement of a mesh in the model frame. Options that are left out are as the format says: a glTF is in metres with its front to
/// +z and its top to +y (glTF 2.0, section 3.4); the other formats are in mm with their front to +x and their top to +z.
///
/// A file that is neither glTF nor turned nor scaled is taken as lying in the model frame already. Any other mesh is moved: the
/// middle of its box over the origin, its lowest point on the ground.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MeshPlacement {
    pub front: Option<SignedAxis>,
    pub up: Option<SignedAxis>,
    /// Length of the scaled mesh from its front to its rear.
    pub length_mm: Option<f64>,
}

impl MeshPlacement {
    /// Returns the front and the top of a mesh by its file's format.
    pub fn usual(file: &Path) -> [SignedAxis; 2] {
        let [front, up] = if is_gltf(file) { [2, 1] } else { [0, 2] };
        [front, up].map(|index| SignedAxis::new(index, false))
    }

    /// Returns the rotation from the frame of this file into the model frame.
    pub fn rotation(&self, file: &Path) -> Result<Matrix3<f64>, MeshError> {
        self.turn(Self::usual(file))
    }

    pub(super) fn apply(&self, mut mesh: Mesh, file: &Path) -> Result<Mesh, MeshError> {
        let is_gltf = is_gltf(file);
        if !is_gltf && *self == Self::default() {
            return Ok(mesh);
        }
        let turn = self.turn(Self::usual(file))?;
        mesh.points.iter_mut().for_each(|p| *p = turn * *p);
        let (low, high) = mesh.bounds_mm();
        let unit_mm = if is_gltf { 1000.0 } else { 1.0 };
        let scale = match self.length_mm {
            None => unit_mm,
            Some(value) if !is_size(value) => return Err(MeshError::BadLength { value }),
            Some(_) if high.x - low.x < LEAST_LENGTH => return Err(MeshError::NoLength),
            Some(length) => length / (high.x - low.x),
        };
        let ground = Point3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z);
        mesh.points
            .iter_mut()
            .for_each(|p| *p = Point3::from(scale * (*p - ground)));
        mesh.frame = FileFrame { turn, ground, scale };
        Ok(mesh)
    }

    /// Returns the rotation from the file's frame into the model frame.
    fn turn(&self, [front, up]: [SignedAxis; 2]) -> Result<Matrix3<f64>, MeshError> {
        let [front, up] = [self.front.unwrap_or(front), self.up.unwrap_or(up)].map(SignedAxis::vector);
        if front.dot(&up) != 0.0 {
            return Err(MeshError::FrontIsUp);
        }
        let left = up.cross(&front);
        Ok(Matrix3::from_rows(&[
            front.transpose(),
            left.transpose(),
            up.transpose(),
        ]))
    }
}
