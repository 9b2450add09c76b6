//! Reasons why no board was printed.

use crate::SheetError;
use scaleproof_core::geometry::length::BadLength;
use scaleproof_core::message::Message;
use scaleproof_pose::board::Definition;
use scaleproof_pose::tags::DictionaryError;

/// Minimum size of a module; smaller ones are illegible from an office printer (about 5 dots at 600 dpi).
pub const MIN_MODULE_MM: f64 = 0.2;

/// Reason why no board was printed.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    #[error(transparent)]
    Sheet(#[from] SheetError),
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error(transparent)]
    Dictionary(#[from] DictionaryError),
    #[error("a board of {columns}×{rows} squares cannot be printed; give {least} to {most} each way", most = Definition::MOST_SQUARES)]
    Squares { columns: u32, rows: u32, least: u32 },
    #[error("a marker of {marker_mm} mm does not fit into a square of {square_mm} mm with white around it")]
    MarkerTooLarge { marker_mm: f64, square_mm: f64 },
    #[error("this board needs {needed} markers and {dictionary} has {count}; use fewer squares or a larger dictionary")]
    NotEnoughMarkers {
        needed: usize,
        dictionary: &'static str,
        count: usize,
    },
    #[error(
        "the markers would have modules of {module_mm:.3} mm, smaller than the {MIN_MODULE_MM} mm a printer can show; make them larger"
    )]
    ModuleTooSmall { module_mm: f64 },
    #[error("a marker size means nothing on {board}; leave it out")]
    MarkerSizeUnused { board: &'static str },
    #[error("a dictionary means nothing on {board}; leave it out")]
    DictionaryUnused { board: &'static str },
    #[error("tag {id} of tag36h11 could not be drawn by the AprilTag library")]
    NoImage { id: u32 },
    #[error("the board is {board_mm} mm and the paper has {free_mm} mm for it; use larger paper or smaller squares")]
    TooLarge { board_mm: String, free_mm: String },
    #[error(transparent)]
    Definition(#[from] Message),
}
