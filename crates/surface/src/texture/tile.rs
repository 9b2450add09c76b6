//! A pattern that is repeated over a model, aligned with the world; one for all sides, or one for each side as an attack makes them with
//! `--laying sides`.

use super::SurfacePoint;
use crate::mesh::Mesh;
use crate::pattern::world_aligned::{Side, WorldAligned};
use crate::pattern::{Pattern, PatternError};

#[derive(Debug, Clone)]
pub struct Tile {
    pub pattern: Pattern,
    /// Width and height of a cell.
    pub cell_mm: f64,
}

impl Tile {
    /// Makes a tile of a pattern whose repeats are this wide.
    pub fn new(pattern: Pattern, tile_mm: f64) -> Self {
        let cell_mm = tile_mm / f64::from(pattern.columns());
        Self { pattern, cell_mm }
    }

    pub fn tile_mm(&self) -> f64 {
        self.cell_mm * f64::from(self.pattern.columns())
    }

    pub(super) fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> [u8; 3] {
        self.mapped().colour_at(self.plane_mm(mesh, at))
    }

    /// Returns column and row of the cell that a point lies in.
    pub fn cell_of(&self, mesh: &Mesh, at: &SurfacePoint) -> [u32; 2] {
        self.mapped().cell_at(self.plane_mm(mesh, at))
    }

    /// Returns the place of a point in the plane of its triangle's side: (u, v), mm.
    pub fn plane_mm(&self, mesh: &Mesh, at: &SurfacePoint) -> [f64; 2] {
        side(mesh, at.triangle).project(&at.place_mm(mesh))
    }

    /// Returns the places of a triangle's corners among the cells.
    pub(super) fn in_cells(&self, mesh: &Mesh, triangle: usize) -> [[f64; 2]; 3] {
        let side = side(mesh, triangle);
        mesh.triangle_mm(triangle)
            .map(|p| side.project(&p).map(|mm| mm / self.cell_mm))
    }

    pub(super) fn cell(&self, place: [f64; 2]) -> [u8; 3] {
        self.mapped().colour_at(place.map(|cells| cells * self.cell_mm))
    }

    fn mapped(&self) -> WorldAligned<'_> {
        WorldAligned {
            pattern: &self.pattern,
            cell_mm: self.cell_mm,
        }
    }
}

fn side(mesh: &Mesh, triangle: usize) -> Side {
    Side::facing(&mesh.normal_mm2(triangle))
}

/// Six patterns, and the side of each triangle.
#[derive(Debug, Clone)]
pub struct SidePatterns {
    /// Tiles, in the order of [`Side::ALL`].
    tiles: Vec<Tile>,
    /// Side of each triangle of the mesh.
    sides: Vec<Side>,
}

impl SidePatterns {
    /// Takes the sides' patterns `below_each_other` in one, in the order of [`Side::ALL`]. `None` where its rows are not those of six.
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
            sides: triangles.map(|i| Side::facing(&mesh.normal_mm2(i))).collect(),
        }))
    }

    pub(super) fn tile(&self, triangle: usize) -> &Tile {
        &self.tiles[self.sides[triangle] as usize]
    }
}
