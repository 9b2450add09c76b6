//! Point of a model's surface.

use crate::mesh::Mesh;
use nalgebra::Point3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Index of the triangle in the mesh.
    pub triangle: usize,
    /// Shares of its corners, which add up to 1.
    pub weights: [f64; 3],
}

impl SurfacePoint {
    /// Returns the point with these shares of the corners of a part of a triangle; `part` are the corners' weights in the whole triangle.
    pub fn in_part(triangle: usize, part: &[[f64; 3]; 3], shares: [f64; 3]) -> Self {
        let weights = std::array::from_fn(|k| (0..3).map(|i| shares[i] * part[i][k]).sum());
        Self { triangle, weights }
    }

    /// Returns its weights on the triangle itself: a point beside it takes the colour at its border.
    pub(crate) fn within(&self) -> [f64; 3] {
        let weights = self.weights.map(|weight| weight.max(0.0));
        let sum: f64 = weights.iter().sum();
        weights.map(|weight| weight / sum)
    }

    /// Returns the place in the model frame, mm.
    pub fn place_mm(&self, mesh: &Mesh) -> Point3<f64> {
        let corners = mesh.triangle_mm(self.triangle);
        let sum = (0..3).fold(nalgebra::Vector3::zeros(), |sum, i| {
            sum + self.weights[i] * corners[i].coords
        });
        Point3::from(sum)
    }
}
