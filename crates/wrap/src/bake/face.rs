//! Triangles with their texture coordinates.

use crate::unwrap::WHOLE;
use scaleproof_core::geometry;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::texture::SurfacePoint;

/// Triangle, or a part of one, in the image.
#[derive(Debug, Clone, PartialEq)]
pub struct BakedFace {
    /// Index of the triangle in the mesh.
    pub triangle: usize,
    /// Barycentric coordinates of each corner in that triangle.
    pub weights: [[f64; 3]; 3],
    /// Texture coordinates: u to the right, v up, the image fills the unit square.
    pub uv: [[f64; 2]; 3],
}

impl BakedFace {
    /// Returns its area in the image, in the unit of its coordinates.
    pub(crate) fn texels(&self) -> f64 {
        let [a, b, c] = self.uv;
        0.5 * geometry::doubled_area(a, b, c).abs()
    }

    pub(crate) fn at(&self, shares: [f64; 3]) -> SurfacePoint {
        SurfacePoint::in_part(self.triangle, &self.weights, shares)
    }
}

/// Flattened part of the paint: each face with its corners in mm.
pub type FlatChart = Vec<BakedFace>;

/// Lays a triangle flat at true size.
pub fn alone(mesh: &Mesh, triangle: usize) -> BakedFace {
    let [a, b, c] = mesh.triangle_mm(triangle);
    let along = b - a;
    let x = along.try_normalize(1e-12).unwrap_or_default();
    let to = c - a;
    let right = to.dot(&x);
    let up = (to - right * x).norm();
    BakedFace {
        triangle,
        weights: WHOLE,
        uv: [[0.0; 2], [along.norm(), 0.0], [right, up]],
    }
}
