//! Printing of a painted model as few flat pieces to glue: true size, with the texture, letters on both sides of every seam, nested on the fewest
//! sheets.
//!
//! [`crate::unwrap`] cuts and flattens the pieces. One file each: a piece in its plane (`flat`), seams between pieces (`seams`), glue tabs, the signs
//! beside them (`labels`), their places on sheets (`nest`, `pages`), the sheets (`draw`), and the first page with its exploded views. [`painted`]
//! makes stencils of them instead.

mod cover;
mod draw;
mod exploded;
mod flat;
mod labels;
mod nest;
mod pages;
pub mod painted;
mod pen;
mod printed;
mod request;
mod seams;
mod tabs;

pub use printed::{PrintedPieces, reason};
pub(crate) use printed::{cm2, left_out_facts};
pub(crate) use request::{AROUND_MM, BLEED_MM};
pub use request::{PiecesError, PiecesRequest};

pub use draw::pieces;
pub use flat::Piece;
pub use nest::Place;
pub use seams::Seam;

pub use crate::unwrap::UnwrapError;
use crate::unwrap::Unwrapped;
use scaleproof_surface::mesh::Mesh;

/// Cuts the paint of some materials (by index; all if there are none) of a mesh in the model frame into pieces that fit on the paper, and flattens
/// them. `progress` is called with the share done.
pub fn flattened(
    surface: (&Mesh, &[usize]),
    request: &PiecesRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, PiecesError> {
    request.unwrapped(surface, draw::fits_mm(request)?, progress)
}
