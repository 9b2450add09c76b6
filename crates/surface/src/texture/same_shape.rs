//! Check that two meshes are the same thing, up to scale and place.

use super::TextureError;
use crate::mesh::Mesh;

/// Share of a mesh's length by which edges may differ: files are written with six digits.
const ROUNDING: f64 = 1e-4;

/// Checks a mesh that brings a texture against the one that is painted, by the lengths of their triangles' edges.
pub fn check_same_shape(textured: &Mesh, given: &Mesh) -> Result<(), TextureError> {
    let counts = [textured, given].map(|mesh| mesh.triangles().len());
    if counts[0] != counts[1] {
        return Err(TextureError::OtherCount {
            textured: counts[0],
            given: counts[1],
        });
    }
    let doubled = |mesh: &Mesh| (0..counts[0]).map(|i| mesh.normal_mm2(i).norm()).sum::<f64>();
    let scale = (doubled(given) / doubled(textured)).sqrt();
    let limit_mm = ROUNDING * given.size_mm().into_iter().fold(0.0, f64::max);
    let differ = |i: &usize| {
        let [a, b] = [edges(textured, *i), edges(given, *i)];
        // Written so that a scale that is no number differs.
        !(0..3).all(|k| (scale * a[k] - b[k]).abs() <= limit_mm)
    };
    let other = (0..counts[0]).find(differ);
    other.map_or(Ok(()), |triangle| Err(TextureError::OtherShape { triangle }))
}

fn edges(mesh: &Mesh, triangle: usize) -> [f64; 3] {
    let [a, b, c] = mesh.triangle_mm(triangle);
    [b - a, c - b, a - c].map(|edge| edge.norm())
}
