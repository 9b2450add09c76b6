//! Colour of each point of a model's surface: a world-aligned pattern, images on the mesh's texture coordinates, texels of each triangle, or patches
//! placed over another texture. Printing, rendering and previews of a painted surface all take it from here.

mod error;
mod face_texels;
mod mapped;
mod patches;
mod point;
mod same_shape;
mod tile;

pub use point::SurfacePoint;

pub use error::TextureError;

pub use face_texels::FaceTexels;
pub use mapped::{Mapped, MappedImages};
pub use patches::PlacedPatch;
pub use same_shape::check_same_shape;
pub use tile::{SidePatterns, Tile};

use crate::mesh::Mesh;

/// The colours of a surface, 8-bit sRGB.
#[derive(Debug, Clone)]
pub enum Texture {
    /// One colour everywhere.
    Flat([u8; 3]),
    /// A pattern, repeated and aligned with the world.
    Tile(Tile),
    Sides(SidePatterns),
    Images(MappedImages),
    /// Colours of each triangle by itself.
    Faces(FaceTexels),
    /// Images in their places, over another texture.
    Patches(Box<Texture>, Vec<PlacedPatch>),
}

impl Texture {
    /// Returns the colour of the texel, cell or pixel that a point lies in: nothing is interpolated, so that no texel takes colour from one beside it
    /// in the image that is elsewhere on the model. Only the texels of one triangle are, as their renderer does it.
    pub fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> [u8; 3] {
        match self {
            Self::Flat(rgb) => *rgb,
            Self::Tile(tile) => tile.colour(mesh, at),
            Self::Sides(patterns) => patterns.tile(at.triangle).colour(mesh, at),
            Self::Images(images) => images.colour(at),
            Self::Faces(texels) => texels.colour(at),
            Self::Patches(below, patches) => {
                // The last one lies on top.
                let on_top = patches.iter().rev().find_map(|patch| patch.colour(mesh, at));
                on_top.unwrap_or_else(|| below.colour(mesh, at))
            }
        }
    }

    /// Returns the places of a triangle's corners in a grid of cells of one colour each, as column and row; `None` where its colours lie in no such
    /// grid.
    pub fn in_cells(&self, mesh: &Mesh, triangle: usize) -> Option<[[f64; 2]; 3]> {
        match self {
            Self::Flat(_) => Some([[0.0; 2]; 3]),
            Self::Tile(tile) => Some(tile.in_cells(mesh, triangle)),
            Self::Sides(patterns) => Some(patterns.tile(triangle).in_cells(mesh, triangle)),
            Self::Images(images) => Some(images.in_cells(triangle)),
            Self::Faces(_) | Self::Patches(..) => None,
        }
    }

    pub fn cell(&self, triangle: usize, cell: [i64; 2]) -> [u8; 3] {
        let middle = cell.map(|number| number as f64 + 0.5);
        match self {
            Self::Flat(rgb) => *rgb,
            Self::Tile(tile) => tile.cell(middle),
            Self::Sides(patterns) => patterns.tile(triangle).cell(middle),
            Self::Images(images) => images.cell(triangle, middle),
            Self::Faces(_) | Self::Patches(..) => [255; 3],
        }
    }

    /// Returns the approximate side of a texel on a triangle's surface, mm, by which the texture is to be sampled there. `None` where the triangle
    /// has one colour.
    pub fn texel_mm(&self, mesh: &Mesh, triangle: usize) -> Option<f64> {
        let area_mm2 = || 0.5 * mesh.normal_mm2(triangle).norm();
        match self {
            Self::Flat(_) => None,
            Self::Tile(tile) => Some(tile.cell_mm),
            Self::Sides(patterns) => Some(patterns.tile(triangle).cell_mm),
            Self::Images(images) => {
                let texels = images.texels(triangle).filter(|texels| *texels > 0.0)?;
                Some((area_mm2() / texels).sqrt())
            }
            // The triangle is half a square of so many texels along each side.
            Self::Faces(texels) => Some((2.0 * area_mm2()).sqrt() / texels.side as f64),
            Self::Patches(below, patches) => {
                let sides = patches.iter().map(PlacedPatch::pixel_mm);
                sides.chain(below.texel_mm(mesh, triangle)).min_by(f64::total_cmp)
            }
        }
    }
}
