//! The pattern on a surface, aligned with the world: a point takes the pattern from the side that its normal looks to most
//! (triplanar mapping without blending, as the evaluation of DTA maps its texture).
//!
//! Each [`Side`] has a plane with coordinates (u, v) in mm: u to the right and v up as a viewer sees it who looks at that side
//! from **outside**. So nothing is mirrored on any side: writing in the pattern reads from left to right on all of them.
//!
//! | side | normal | u | v | the model's front is |
//! |---|---|---|---|---|
//! | left | +y | −x | z | at the viewer's left |
//! | right | −y | x | z | at the right |
//! | roof | +z | −y | x | up |
//! | front | +x | y | z | towards the viewer |
//! | rear | −x | −y | z | away |
//! | bottom | −z | y | x | up |
//!
//! **Phase**: u = v = 0 is the origin of the model frame and the top-left corner of the pattern's top-left cell, on every side.
//! So the borders between cells are where the surface meets the planes x, y, z = k · cell, and they run on from one side to the
//! next wherever the sides meet. The same rows of the pattern run around left, front, right and rear at the same height.

use nalgebra::{Point3, Vector3};

use super::Pattern;

/// Distance (as a share of the normal's length) from the edge between two sides within which normals count as on it, so that the two triangles
/// of a flat chamfer at 45° do not part by rounding.
const TIE: f64 = 1e-4;

/// A side of the model, by the direction its surface looks to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    Left,
    Right,
    Roof,
    Front,
    Rear,
    Bottom,
}

impl Side {
    pub const ALL: [Self; 6] = [
        Self::Left,
        Self::Right,
        Self::Roof,
        Self::Front,
        Self::Rear,
        Self::Bottom,
    ];

    /// Returns the side a surface belongs to by its outward normal of any length (model frame). Of equals the roof or bottom comes
    /// first, then left or right; a normal of length 0 is the bottom's, which is not printed.
    pub fn facing(normal: &Vector3<f64>) -> Self {
        let [x, y, z] = [normal.x, normal.y, normal.z].map(f64::abs);
        let slack = TIE * normal.norm();
        let pick = |value: f64, positive: Self, negative: Self| if value > 0.0 { positive } else { negative };
        if z + slack >= x.max(y) {
            pick(normal.z, Self::Roof, Self::Bottom)
        } else if y + slack >= x {
            pick(normal.y, Self::Left, Self::Right)
        } else {
            pick(normal.x, Self::Front, Self::Rear)
        }
    }

    /// Returns the name of the side in commands and on paper.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Roof => "roof",
            Self::Front => "front",
            Self::Rear => "rear",
            Self::Bottom => "bottom",
        }
    }

    /// Returns unit vectors of u and v in the model frame.
    pub fn axes(self) -> [Vector3<f64>; 2] {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        match self {
            Self::Left => [-x, z],
            Self::Right => [x, z],
            Self::Roof => [-y, x],
            Self::Front => [y, z],
            Self::Rear => [-y, z],
            Self::Bottom => [y, x],
        }
    }

    /// Returns the outward direction in the model frame.
    pub fn outward(self) -> Vector3<f64> {
        let [right, up] = self.axes();
        right.cross(&up)
    }

    /// Projects a point of the model frame into the side's plane: (u, v), mm.
    pub fn project(self, point_mm: &Point3<f64>) -> [f64; 2] {
        self.axes().map(|axis| axis.dot(&point_mm.coords))
    }
}

#[derive(Debug, Clone, Copy)]
pub struct WorldAligned<'a> {
    pub pattern: &'a Pattern,
    /// Width and height of a cell on the model.
    pub cell_mm: f64,
}

impl WorldAligned<'_> {
    /// Returns the colour of a surface point (model frame, mm) with this outward normal of any length.
    pub fn colour(&self, point_mm: &Point3<f64>, normal: &Vector3<f64>) -> [u8; 3] {
        let side = Side::facing(normal);
        self.colour_at(side.project(point_mm))
    }

    /// Returns the colour at (u, v) of any side, mm.
    pub fn colour_at(&self, at_mm: [f64; 2]) -> [u8; 3] {
        let [column, row] = self.cell_at(at_mm);
        self.pattern.cells().get_pixel(column, row).0
    }

    /// Returns column and row of the pattern's cell at (u, v) of any side, mm.
    pub fn cell_at(&self, [u_mm, v_mm]: [f64; 2]) -> [u32; 2] {
        let cell = |mm: f64, count: u32| (mm / self.cell_mm).floor().rem_euclid(f64::from(count)) as u32;
        let (column, row) = (cell(u_mm, self.pattern.columns()), cell(-v_mm, self.pattern.rows()));
        // rem_euclid of a tiny negative number rounds up to the count itself.
        [column % self.pattern.columns(), row % self.pattern.rows()]
    }
}
