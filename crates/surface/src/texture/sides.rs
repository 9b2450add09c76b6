//! A pattern of its own for each side of a model, as an attack makes it with `--laying sides`: each is laid as a pattern that all sides share is
//! ([`crate::pattern::world_aligned`]).

use super::{SurfacePoint, Tile};
use crate::mesh::Mesh;
use crate::pattern::world_aligned::Side;
use crate::pattern::{Pattern, PatternError};

/// Six patterns, and which of them each triangle has.
#[derive(Debug, Clone)]
pub struct SidePatterns {
    /// In the order of [`Side::ALL`].
    tiles: Vec<Tile>,
    /// Of each triangle of the mesh.
    sides: Vec<Side>,
}

impl SidePatterns {
    /// `below_each_other`: the sides' patterns in one, in the order of [`Side::ALL`]. `None` where its rows are not those of six.
    ///
    /// # Errors
    /// Only if an encoder fails.
    pub fn new(below_each_other: &Pattern, tile_mm: f64, mesh: &Mesh) -> Result<Option<Self>, PatternError> {
        let count = Side::ALL.len() as u32;
        let rows = below_each_other.rows() / count;
        if rows == 0 || below_each_other.rows() != rows * count {
            return Ok(None);
        }
        let tile = |side: &Side| {
            let pattern = below_each_other.rows_from(*side as u32 * rows, rows)?;
            Ok(Tile::new(pattern, tile_mm))
        };
        let triangles = 0..mesh.triangles().len();
        Ok(Some(Self {
            tiles: Side::ALL.iter().map(tile).collect::<Result<_, PatternError>>()?,
            sides: triangles.map(|i| Side::of(&mesh.normal_mm2(i))).collect(),
        }))
    }

    pub(super) fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> [u8; 3] {
        self.tile(at.triangle).colour(mesh, at)
    }

    pub(super) fn in_cells(&self, mesh: &Mesh, triangle: usize) -> [[f64; 2]; 3] {
        self.tile(triangle).in_cells(mesh, triangle)
    }

    pub(super) fn cell(&self, triangle: usize, place: [f64; 2]) -> [u8; 3] {
        self.tile(triangle).cell(place)
    }

    /// Width of a cell.
    pub(super) fn cell_mm(&self) -> f64 {
        self.tiles[0].cell_mm
    }

    fn tile(&self, triangle: usize) -> &Tile {
        &self.tiles[self.sides[triangle] as usize]
    }
}
