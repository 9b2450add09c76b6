//! Paper: everything that is printed is drawn on [`sheet::Sheet`]s in millimetres and written by [`pdf`] or [`svg`].
//!
//! One file or folder per kind of print ([`template`], [`tags`], [`board`], [`check`], [`chart`]); what they share ([`page`], [`paper`],
//! [`frame`], [`ruler`], [`lettering`], [`shapes`], [`printer`]) stands beside them.

#[cfg(feature = "full")]
pub mod board;
pub mod chart;
pub mod check;
pub mod date;
pub mod frame;
pub mod lettering;
mod pack;
pub mod page;
pub mod paint;
pub mod paper;
pub mod patch;
pub mod pdf;
pub mod printer;
pub mod ruler;
pub mod shapes;
pub mod sheet;
pub mod svg;
pub mod tags;
pub mod template;
pub mod wrap;

use std::path::PathBuf;

use crate::geometry::length::{BadLength, shown};
use crate::spelling;

/// Why nothing was printed. Each variant is a sentence that says what to change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrintError {
    #[error(
        "paper '{text}' is not known; use a4, a3, letter, tabloid, WIDTHxHEIGHT in mm, as in 210x297, or a roll by its width, as in roll610{}",
        spelling::hint(text, ["a4", "a3", "letter", "tabloid"])
    )]
    UnknownPaper { text: String },
    #[error("size '{text}' is not understood; write WIDTHxHEIGHT in mm, as in 600x300")]
    UnknownSize { text: String },
    #[error(transparent)]
    Length(#[from] BadLength),
    #[error("{what} cannot be {value}; give {wanted}", value = shown(*value))]
    BadNumber {
        what: &'static str,
        value: f64,
        wanted: &'static str,
    },
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
    #[error(
        "the pattern would be placed {count:.0} times, more than {most:.0}; use a larger tile, a smaller size, or less overlap and bleed"
    )]
    TooManyPlacements { count: f64, most: f64 },
    #[error(
        "the unrolled strips would take {count} cells, more than {most}; use a larger tile, or a larger --max-stretch"
    )]
    TooManyStripCells { count: usize, most: usize },
    #[error(
        "a cell would be {cell_mm:.3} mm, smaller than the {least_mm} mm a printer can show; use a larger tile or fewer cells"
    )]
    CellTooSmall { cell_mm: f64, least_mm: f64 },
    #[error("'{text}' is no date; write YYYY-MM-DD, as in 2026-11-21")]
    BadDate { text: String },
    #[error(
        "100 mm that measure {measured_mm} mm along {axis} are more than 5 % off: the print was scaled; print the check page again \
         at 100 % (no fit to page) and measure both rulers in mm",
        measured_mm = shown(*measured_mm)
    )]
    ImplausiblePrinter { axis: &'static str, measured_mm: f64 },
    #[error("the smallest colour chart is {chart_mm} mm and the paper has {free_mm} mm for it; use larger paper")]
    NoRoomForChart { chart_mm: String, free_mm: String },
    #[error("tag {id} of the colour chart could not be drawn by the AprilTag library")]
    NoTagImage { id: u32 },
    #[error("{path} cannot be used ({reason}); make it with `scaleproof print verify`", path = path.display())]
    BadPrinterFile { path: PathBuf, reason: String },
    #[error(
        "the mesh is {mesh_mm} mm (length × width × height) but the scene's model is {scene_mm} mm; give --length-mm, or \
         --mesh-front and --mesh-up if the mesh lies otherwise, or correct size_mm of the scene"
    )]
    OtherSize { mesh_mm: String, scene_mm: String },
    #[error(
        "the paint has no surface on any of the five sides; name other materials, or check which way up the mesh is"
    )]
    NothingToPrint,
    #[error(
        "{count} triangles are steeper than --max-stretch, and no more than {most} can be unrolled; simplify the mesh, or give a \
         larger --max-stretch"
    )]
    TooManySteep { count: usize, most: usize },
    #[error("the patch {path} cannot be used ({reason})", path = path.display())]
    BadPatch { path: PathBuf, reason: String },
    #[error("the paint has no {side} panel; choose another panel or other materials")]
    NoPanel { side: &'static str },
    #[error(
        "the patch lies wholly beside the {side} panel, which reaches from {low_mm} to {high_mm} mm (right, up); give a place on it"
    )]
    OffPanel {
        side: &'static str,
        low_mm: String,
        high_mm: String,
    },
    #[error("the PDF could not be put together: {reason}")]
    Pdf { reason: String },
}
