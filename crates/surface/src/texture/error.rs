//! Reasons why a texture cannot be used.

use crate::pattern::picture::PictureError;
use scaleproof_core::files::FileError;
use std::path::PathBuf;

/// Reason why there is no texture. Each variant says what to change.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Image(#[from] PictureError),
    #[error("the texture {path} cannot be used: {reason}", path = path.display())]
    Unusable { path: PathBuf, reason: String },
    #[error("the mesh's material '{material}' cannot be painted: {reason}")]
    Material { material: String, reason: String },
    #[error("no material of the mesh's paint has an image; give an image, or a mesh with images")]
    NoImages,
    #[error(
        "{}, so an image cannot be laid on; unwrap the mesh, or paint other faces",
        TextureError::coverage(missing, all)
    )]
    NoCoordinates { missing: usize, all: usize },
    #[error("a texture coordinate of the mesh is {value}, which is damage; unwrap the mesh again")]
    BadCoordinate { value: f64 },
    #[error(
        "the textured mesh has {textured} triangles and the mesh {given}; give the mesh that the texture was made for"
    )]
    OtherCount { textured: usize, given: usize },
    #[error(
        "triangle {triangle} of the textured mesh has another shape than in the mesh; give the mesh that the texture was made for"
    )]
    OtherShape { triangle: usize },
}
