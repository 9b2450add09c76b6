//! Reasons why there is no sheet.

use scaleproof_core::geometry::length::BadLength;
use scaleproof_plot::pdf::PdfError;

/// Reason why there is no sheet, whatever it would show.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetError {
    #[error(
        "paper '{text}' is not known; use a0 to a5, letter, legal, tabloid, ledger, WIDTHxHEIGHT in mm, as in 210x297, or a roll by its width, as in roll610{near}"
    )]
    UnknownPaper {
        text: String,
        /// Clause with the nearest known name; empty if there is none.
        near: String,
    },
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
