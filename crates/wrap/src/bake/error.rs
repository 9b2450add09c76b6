//! Reasons why a texture was not baked.

use crate::unwrap::UnwrapError;

/// Sides of the image in pixels: a smaller one shows no pattern, and a larger one no engine loads.
pub const SIDE_PX: std::ops::RangeInclusive<u32> = 64..=8192;

/// Reason why there is no image.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    #[error("the sides of a texture's image are 64 to 8192 px, not {width} × {height}")]
    BadSize { width: u32, height: u32 },
    #[error("the mesh has no triangles of the paint's materials")]
    NoPaint,
    #[error(
        "the paint has {charts} pieces, which do not fit into an image of {width} × {height} px; give a larger size"
    )]
    TooSmall { charts: usize, width: u32, height: u32 },
    #[error(transparent)]
    Unwrap(#[from] UnwrapError),
}
