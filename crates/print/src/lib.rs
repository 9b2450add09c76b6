//! Printing in true millimetres as PDF or SVG: templates, paint stencils, tags, boards, patches, the colour chart.
//!
//! Everything printed is drawn as vectors on [`sheet::Sheet`]s, in the millimetres measured on paper, and [`output`] writes them to files by
//! [`pdf`] or [`svg`].
//!
//! One file or folder per kind of print, each with its request and its error: [`template`], [`paint`], [`wrap`], [`patch`], [`tags`], `board`,
//! [`chart`], [`check`]. Shared parts: [`page`], [`paper`], [`printer`], `frame`, `ruler`, `shapes`.
//!
//! ```
//! use scaleproof_print::media::Media;
//! use scaleproof_print::paper::{Orientation, Paper};
//! use scaleproof_print::template::{Front, LayoutRequest, TemplateRequest, template};
//! use scaleproof_surface::pattern::Pattern;
//!
//! let request = TemplateRequest {
//!     tile_mm: 118.0,
//!     scale: 10.0,
//!     pattern_name: "random".into(),
//!     front: Front::Left,
//!     layout: LayoutRequest {
//!         size_mm: (600.0, 300.0),
//!         media: Media::new(Paper::A4),
//!         orientation: Orientation::Auto,
//!         overlap_mm: 8.0,
//!         bleed_mm: 2.0,
//!     },
//! };
//! let made = template(&Pattern::random(16, 1)?, &request)?;
//! assert!(made.pages.len() > 6, "a first page, and six sheets of A4");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod colour_chart;

#[cfg(feature = "full")]
pub mod board;
pub mod buckets;
pub mod chart;
pub mod check;
pub mod date;
pub mod frame;
pub mod media;
pub mod output;
pub mod pack;
pub mod page;
pub mod paint;
pub mod paper;
pub mod patch;
pub mod pdf;
pub mod polygon;
pub mod printer;
pub mod raster;
pub mod ruler;
pub mod shapes;
pub mod sheet;
pub mod svg;
pub mod tags;
pub mod template;
pub mod wrap;

use scaleproof_core::geometry::length::BadLength;
use scaleproof_core::spelling;
use scaleproof_plot::pdf::PdfError;

/// Reason why there is no sheet, whatever it would show.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetError {
    #[error(
        "paper '{text}' is not known; use a0 to a5, letter, legal, tabloid, ledger, WIDTHxHEIGHT in mm, as in 210x297, or a roll by its width, as in roll610{}",
        spelling::hint(text, paper::Paper::NAMED.map(|(name, _)| name))
    )]
    UnknownPaper { text: String },
    #[error("boards and charts are printed on sheets: give a paper's name, as a4 or letter, or WIDTHxHEIGHT in mm")]
    Roll,
    #[error("size '{text}' is not understood; write WIDTHxHEIGHT in mm, as in 600x300")]
    UnknownSize { text: String },
    #[error("'{text}' is no date; write YYYY-MM-DD, as in 2026-11-21")]
    BadDate { text: String },
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error(
        "the paper ({paper_mm} mm) is too small: with a margin of {margin_mm} mm the 100 mm rulers and the captions need at least \
         {needed_mm} mm"
    )]
    PaperTooSmall {
        paper_mm: String,
        margin_mm: f64,
        needed_mm: String,
    },
    #[error(
        "an overlap of {overlap_mm} mm and a bleed of {bleed_mm} mm leave nothing of the {usable_mm} mm a sheet can carry; use less \
         of both or larger paper"
    )]
    OverlapTooLarge {
        overlap_mm: f64,
        bleed_mm: f64,
        usable_mm: String,
    },
    #[error("this needs more than {most} sheets; use larger paper, less overlap or a smaller size")]
    TooManySheets { most: usize },
    #[error(transparent)]
    Pdf(#[from] PdfError),
}
