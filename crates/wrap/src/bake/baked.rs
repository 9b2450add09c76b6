//! Baked texture.

use super::face::BakedFace;
use super::own::NotKept;
use image::RgbImage;

/// The image and the place of each part of the paint in it.
#[derive(Debug, Clone)]
pub struct Baked {
    pub image: RgbImage,
    /// Faces, sorted by triangle.
    pub faces: Vec<BakedFace>,
    /// Number of connected parts of the paint in the image.
    pub charts: usize,
    /// Reason why the mesh's own coordinates are not kept.
    pub unwrapped: Option<NotKept>,
    /// Side of a texel of mean area on the model.
    pub texel_mm: f64,
}
