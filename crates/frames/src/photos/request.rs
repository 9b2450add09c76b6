//! The settings of frames from photos.

use nalgebra::Point3;

use scaleproof_surface::mesh::Mesh;

/// Samples of the surface along each side of a pixel.
pub const FACTOR: u32 = 3;

/// The settings of frames from photos.
#[derive(Debug, Clone)]
pub struct PhotoFramesRequest {
    pub mesh: Mesh,
    /// Indices of the materials that are the paint; all when empty.
    pub materials: Vec<usize>,
    pub target_mm: Point3<f64>,
    /// Colours of the paint, 8-bit sRGB of its reflectance. Every view has all of them.
    pub flats: Vec<[u8; 3]>,
    /// Width of the frames, px.
    pub width_px: u32,
    /// The command that makes the frames.
    pub made_by: String,
}
