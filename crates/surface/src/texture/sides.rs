//! A pattern of its own for each side of a model, as an attack makes it with `--laying sides`: each is laid as a pattern that all sides share is
//! ([`crate::pattern::world_aligned`]).

use super::{SurfacePoint, Tile};
use crate::mesh::{Mesh, doubled_area};
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
            Ok(Tile::new(
                below_each_other.rows_from(*side as u32 * rows, rows)?,
                tile_mm,
            ))
        };
        let triangles = mesh.triangles().iter();
        Ok(Some(Self {
            tiles: Side::ALL.iter().map(tile).collect::<Result<_, PatternError>>()?,
            sides: triangles
                .map(|t| Side::of(&doubled_area(&mesh.corners_mm(t))))
                .collect(),
        }))
    }

    pub(super) fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> [u8; 3] {
        self.of(at.triangle).colour(mesh, at)
    }

    pub(super) fn in_cells(&self, mesh: &Mesh, triangle: usize) -> [[f64; 2]; 3] {
        self.of(triangle).in_cells(mesh, triangle)
    }

    pub(super) fn cell(&self, triangle: usize, place: [f64; 2]) -> [u8; 3] {
        self.of(triangle).cell(place)
    }

    /// Width of a cell.
    pub(super) fn cell_mm(&self) -> f64 {
        self.tiles[0].cell_mm
    }

    fn of(&self, triangle: usize) -> &Tile {
        &self.tiles[self.sides[triangle] as usize]
    }
}
