//! Request for a model in pieces to paint.

use crate::pieces::{AROUND_MM, PiecesError, PiecesRequest};
use scaleproof_print::paint::{PaintError, rim_mm};

/// Room beyond the rim for the cutting line.
pub const BEYOND_RIM_MM: f64 = 2.0;

/// Reason why no painted pieces were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PaintedError {
    #[error(transparent)]
    Pieces(#[from] PiecesError),
    #[error(transparent)]
    Paint(#[from] PaintError),
}

/// Settings of painted pieces. Tabs, resolution and bleed of the pieces are ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct PaintedRequest {
    pub pieces: PiecesRequest,
    /// Minimum width of bridges and openings.
    pub min_feature_mm: f64,
    /// True to mirror the stencils, as seen from their back.
    pub mirror: bool,
}

impl PaintedRequest {
    pub fn title(&self) -> String {
        format!("Paint sheets of {}", self.pieces.sheets.name)
    }

    pub(crate) fn around_mm(&self) -> f64 {
        AROUND_MM.max(rim_mm(self.min_feature_mm) + BEYOND_RIM_MM)
    }
}
