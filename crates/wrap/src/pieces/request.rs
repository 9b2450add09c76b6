//! Request for a model in pieces.

use crate::unwrap::{UnwrapError, UnwrapRequest, Unwrapped, unwrap};
use scaleproof_core::geometry::length::BadLength;
use scaleproof_print::SheetError;
use scaleproof_print::raster::RasterError;
use scaleproof_print::template::{TemplateError, TemplateRequest};
use scaleproof_print::wrap::WrapRequest;
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::world_aligned::Side;

/// Extension of the texture beyond a piece's outline.
pub const BLEED_MM: f64 = 2.0;

/// Room around a piece: bleed, a label and some air.
pub const AROUND_MM: f64 = 12.0;

/// Reason why no pieces were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PiecesError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Template(#[from] TemplateError),
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error(transparent)]
    Raster(#[from] RasterError),
    #[error(transparent)]
    Unwrap(#[from] UnwrapError),
    #[error("piece {piece} does not fit on a sheet with its letters; use larger paper")]
    TooLarge { piece: usize },
}

#[derive(Debug, Clone, PartialEq)]
pub struct PiecesRequest {
    /// Bounds of the pieces; their maximum size is replaced by the paper's.
    pub unwrap: UnwrapRequest,
    /// Width of the glue tabs, mm; `None` for no tabs.
    pub tabs_mm: Option<f64>,
    /// Sheets as for panels. No piece extends over several sheets, so the overlap is ignored.
    pub sheets: WrapRequest,
}

impl PiecesRequest {
    pub fn title(&self) -> String {
        format!("Pieces of {}", self.sheets.name)
    }

    /// Cuts and flattens the paint of some materials of a mesh into pieces of at most this size.
    pub(crate) fn unwrapped(
        &self,
        (mesh, materials): (&Mesh, &[usize]),
        fits_mm: [f64; 2],
        progress: &mut dyn FnMut(f64),
    ) -> Result<Unwrapped, PiecesError> {
        let request = UnwrapRequest {
            fits_mm: Some(fits_mm),
            ..self.unwrap.clone()
        };
        Ok(unwrap(mesh, materials, &request, progress)?)
    }

    pub(crate) fn template(&self) -> TemplateRequest {
        self.sheets.template(Side::Front, (1.0, 1.0))
    }
}
