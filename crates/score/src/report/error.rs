//! Error of a report that cannot be written.

use scaleproof_core::files;
use scaleproof_plot::pdf::PdfError;

/// Reason why the report could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the report could not be put together: {0}")]
    Json(#[from] serde_json::Error),
    #[error("the report could not be put together: {0}")]
    Csv(#[from] ::csv::Error),
    #[error(transparent)]
    Figure(#[from] PdfError),
}
