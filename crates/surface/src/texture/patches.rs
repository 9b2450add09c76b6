//! Patches: images placed on the model's sides.

use std::sync::Arc;

use image::RgbImage;
use nalgebra::Point3;

use super::SurfacePoint;
use crate::mesh::Mesh;
use crate::pattern::world_aligned::Side;

#[derive(Debug, Clone)]
pub struct PlacedPatch {
    pub image: Arc<RgbImage>,
    pub side: Side,
    /// Its middle in the side's plane, (u, v) in mm.
    pub at_mm: [f64; 2],
    pub size_mm: (f64, f64),
}

impl PlacedPatch {
    /// Returns the shorter side of a pixel, mm.
    pub(super) fn pixel_mm(&self) -> f64 {
        let (width, height) = self.image.dimensions();
        (self.size_mm.0 / f64::from(width)).min(self.size_mm.1 / f64::from(height))
    }

    /// Returns the colour at a point; `None` beside the patch.
    pub(super) fn colour(&self, mesh: &Mesh, at: &SurfacePoint) -> Option<[u8; 3]> {
        self.colour_at(Side::facing(&mesh.normal_mm2(at.triangle)), &at.place_mm(mesh))
    }

    /// Returns the colour at a place (model frame, mm) of a surface that looks to a side; `None` beside the patch.
    pub fn colour_at(&self, side: Side, place_mm: &Point3<f64>) -> Option<[u8; 3]> {
        if side != self.side {
            return None;
        }
        let [u, v] = self.side.project(place_mm);
        let across = (u - self.at_mm[0]) / self.size_mm.0 + 0.5;
        let down = 0.5 - (v - self.at_mm[1]) / self.size_mm.1;
        let pixel = |share: f64, count: u32| {
            let is_within = (0.0..1.0).contains(&share);
            is_within.then(|| ((share * f64::from(count)) as u32).min(count - 1))
        };
        let (column, row) = (pixel(across, self.image.width())?, pixel(down, self.image.height())?);
        self.image.get_pixel_checked(column, row).map(|pixel| pixel.0)
    }
}
