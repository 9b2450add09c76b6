//! What colour each point of a model's surface has: a world-aligned pattern, images on the mesh's texture coordinates, texels of each
//! triangle, or patches placed over another texture. Whatever prints, renders or previews a painted surface asks here.

mod patches;
mod tile;

pub(crate) use patches::PlacedPatch;
pub(crate) use tile::Tile;

use nalgebra::Point3;

use crate::mesh::Mesh;
use crate::pattern::light;

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Of the mesh.
    pub triangle: usize,
    /// Shares of its corners, which add up to 1.
    pub weights: [f64; 3],
}

impl SurfacePoint {
    /// Model frame, mm.
    pub(crate) fn place_mm(&self, mesh: &Mesh) -> Point3<f64> {
        let corners = mesh.corners_mm(&mesh.triangles()[self.triangle]);
        let sum = (0..3).fold(nalgebra::Vector3::zeros(), |sum, i| {
            sum + self.weights[i] * corners[i].coords
        });
        Point3::from(sum)
    }
}

/// The colours of a surface, 8-bit sRGB.
#[derive(Debug, Clone)]
pub(crate) enum Texture {
    /// One colour everywhere.
    Flat([u8; 3]),
    /// A pattern, repeated and aligned with the world.
    Tile(Tile),
    /// Images in their places, over another texture.
    Patches(Box<Texture>, Vec<PlacedPatch>),
}

impl Texture {
    /// The colour of the texel, cell or pixel that a point lies in: nothing is interpolated, so that no texel takes colour from one beside it
    /// in the image that is elsewhere on the model.
    pub(crate) fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> [u8; 3] {
        match self {
            Self::Flat(rgb) => *rgb,
            Self::Tile(tile) => tile.colour(mesh, at),
            Self::Patches(below, patches) => {
                // The last one lies on top.
                let on_top = patches.iter().rev().find_map(|patch| patch.colour(mesh, at));
                on_top.unwrap_or_else(|| below.colour(mesh, at))
            }
        }
    }

    /// The mean of the colours at some points, as light adds them; `None` of no points.
    pub(crate) fn mean(&self, mesh: &Mesh, points: impl Iterator<Item = SurfacePoint>) -> Option<[u8; 3]> {
        let (mut sum, mut count) = ([0.0; 3], 0_u32);
        for point in points {
            let linear = light::linear_of(self.colour(mesh, &point));
            (0..3).for_each(|c| sum[c] += linear[c]);
            count += 1;
        }
        (count > 0).then(|| light::rgb_of(sum.map(|v| v / f64::from(count))))
    }
}
