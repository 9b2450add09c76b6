//! Sheets of `print wrap`, resolved from its arguments.

use crate::cli::Result;
use crate::cli::args::wrap::{DPI, OVERLAP_MM, SheetArgs};
use scaleproof_print::wrap::WrapRequest;

impl SheetArgs {
    pub fn request(&self, scale: f64) -> Result<WrapRequest> {
        Ok(WrapRequest {
            scale,
            name: String::new(),
            facts: String::new(),
            dpi: DPI,
            overlap_mm: self.overlap_mm.unwrap_or(OVERLAP_MM),
            media: self.paper.media()?,
        })
    }
}
