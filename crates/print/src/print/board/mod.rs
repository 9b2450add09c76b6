//! Calibration boards on one sheet: ChArUco, chessboard, AprilGrid.

mod definition;
mod draw;

pub use definition::definition;
pub use scaleproof_pose::board::Definition;

use super::SheetError;
use super::frame::PageFrame;
use super::page::Media;
use super::printer::Printer;
use super::sheet::{Mark, PointMm, RectMm, Sheet};
use scaleproof_core::geometry::length::BadLength;
use scaleproof_plot::lettering::size;
use scaleproof_pose::board::DefinitionError;
use scaleproof_pose::tags::DictionaryError;

/// Smaller modules than this come out of an office printer as mush (about 5 dots at 600 dpi).
const MIN_MODULE_MM: f64 = 0.2;
/// White paper between the board and whatever else is on the page, besides what the page keeps free anyway.
const QUIET_MM: f64 = 1.0;

/// Why no board was printed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
    Definition(#[from] DefinitionError),
}

/// The kinds of calibration boards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoardKind {
    Charuco,
    Chessboard,
    Aprilgrid,
}

/// A request for a calibration board. Lengths in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardRequest {
    pub kind: BoardKind,
    /// Columns and rows; of an AprilGrid, of tags.
    pub squares: (u32, u32),
    /// Side of a square; of an AprilGrid, from tag to tag.
    pub square_mm: f64,
    /// Outer edge of a marker's or tag's black border; `None` is the usual share of the square.
    pub marker_mm: Option<f64>,
    /// OpenCV's name of the ChArUco markers' dictionary; `None` is [`Definition::DICTIONARY`].
    pub dictionary: Option<String>,
    pub media: Media,
}

/// A board ready to be written.
#[derive(Debug, Clone)]
pub struct Board {
    pub definition: Definition,
    /// Where it lies (page frame).
    pub area: RectMm,
    pub sheet: Sheet,
}

/// Draws a board in the middle of one sheet.
///
/// # Errors
/// A roll, numbers that make no board, too few markers in the dictionary, a board larger than the paper.
pub fn board(request: &BoardRequest) -> Result<Board, BoardError> {
    let media = request.media;
    media.check_is_cut()?;
    let definition = definition(request)?;
    let size_mm = definition.size_mm();
    let Some((page, area)) = media.with_room(size_mm, QUIET_MM)? else {
        let free = media.both_ways()?.last().map(PageFrame::usable_size);
        let (width, height) = free.unwrap_or_default();
        return Err(BoardError::TooLarge {
            board_mm: size(size_mm),
            free_mm: size((width - 2.0 * QUIET_MM, height - 2.0 * QUIET_MM)),
        });
    };
    let corner = PointMm::new(area.left_mm, area.top_mm);
    let marks = vec![Mark::black(draw::black(&definition, corner)?)];
    let captions = captions(&definition, &media.printer);
    let sheet = page.labelled(page.printable, marks, &captions, definition.name());
    Ok(Board {
        definition,
        area,
        sheet,
    })
}

fn captions(definition: &Definition, printer: &Printer) -> Vec<String> {
    vec![
        "Print at 100 % (no fit to page): both rulers must measure 100 mm.".to_owned(),
        "Glue the sheet to something flat and stiff; a board that bends spoils a calibration.".to_owned(),
        definition.line(),
        format!("{} · scaleproof {}", printer.caption(), env!("CARGO_PKG_VERSION")),
    ]
}
