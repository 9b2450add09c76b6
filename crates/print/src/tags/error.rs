//! Reasons why no tags were printed.

use crate::SheetError;
use std::fmt;

/// Minimum size of a module; smaller ones are illegible from an office printer (about 5 dots at 600 dpi).
pub const MIN_MODULE_MM: f64 = 0.2;

/// Reason why no tags were printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TagPrintError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error("the scene has no tags; add [[tag]] tables to it, or make one with `scaleproof scene new`")]
    NoTags,
    #[error("tag {id} of {family} could not be drawn: the AprilTag library does not have it")]
    NoImage { family: &'static str, id: u32 },
    #[error(
        "tag {id} would have modules of {module_mm:.3} mm, smaller than the {MIN_MODULE_MM} mm a printer can show; use larger tags"
    )]
    ModuleTooSmall { id: u32, module_mm: f64 },
    #[error("{what} takes {needed_mm} mm and the paper has {free_mm} mm for it; use larger paper{instead}")]
    TooLarge {
        what: String,
        needed_mm: String,
        free_mm: String,
        instead: Instead,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instead {
    Nothing,
    WholeMat,
    PlainCards,
}

impl fmt::Display for Instead {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nothing => "",
            Self::WholeMat => ", or print the whole mat",
            Self::PlainCards => ", or print plain cards",
        })
    }
}
