//! Reasons why a mesh was not unwrapped.

use super::request::STRETCH;

/// Maximum number of triangles; more take minutes.
pub const MAX_TRIANGLES: usize = 200_000;

/// Reason why there are no pieces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnwrapError {
    #[error("the mesh has no paint that can be seen; check the paint's name and which way is up")]
    NoPaint,
    #[error("the paint has {count} triangles and is cut into pieces up to {MAX_TRIANGLES}; simplify the mesh")]
    TooManyTriangles { count: usize },
    #[error(
        "the paint takes {needed} pieces of this size and stretch, and {most} are allowed; allow more pieces, more stretch or larger paper"
    )]
    TooFewPieces { most: usize, needed: usize },
    #[error("a stretch of {value} cannot be asked for; {} to {} can", STRETCH.start(), STRETCH.end())]
    BadStretch { value: f64 },
    #[error("pieces of {} × {} mm are too small for this model", size_mm[0], size_mm[1])]
    BadSize { size_mm: [f64; 2] },
}
