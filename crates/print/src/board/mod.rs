//! Calibration boards on one sheet: ChArUco, chessboard, AprilGrid.

mod draw;
mod error;

pub use error::BoardError;
pub(crate) use error::MIN_MODULE_MM;

pub use scaleproof_pose::board::Definition;

use super::frame::PageFrame;
use super::media::Media;
use super::sheet::{Mark, RectMm, Sheet};
use super::template::making;
use scaleproof_core::geometry::length;
use scaleproof_plot::lettering::size;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{MarkerDictionary, Modules};

/// White paper between the board and anything else on the page, besides the page's own margins.
const QUIET_MM: f64 = 1.0;

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
    /// Columns and rows of squares; of tags for an AprilGrid.
    pub squares: (u32, u32),
    /// Side of a square; distance from tag to tag for an AprilGrid.
    pub square_mm: f64,
    /// Outer edge of a marker's or tag's black border; `None` is the usual share of the square.
    pub marker_mm: Option<f64>,
    /// OpenCV's name of the ChArUco markers' dictionary; `None` is [`Definition::DICTIONARY`].
    pub dictionary: Option<String>,
    pub media: Media,
}

#[derive(Debug, Clone)]
pub struct Board {
    pub definition: Definition,
    /// Area of the board (page frame).
    pub area: RectMm,
    pub sheet: Sheet,
}

/// Returns the definition of a printable board.
pub fn definition(request: &BoardRequest) -> Result<Definition, BoardError> {
    let (columns, rows) = request.squares;
    let (squares, square_mm) = ([columns, rows], request.square_mm);
    let least = if request.kind == BoardKind::Aprilgrid { 1 } else { 3 };
    if !squares.iter().all(|n| (least..=Definition::MOST_SQUARES).contains(n)) {
        return Err(BoardError::Squares { columns, rows, least });
    }
    length::size_mm("square", square_mm)?;
    let without_dictionary = |board: &'static str| match request.dictionary {
        Some(_) => Err(BoardError::DictionaryUnused { board }),
        None => Ok(()),
    };
    Ok(match request.kind {
        BoardKind::Charuco => {
            let dictionary = MarkerDictionary::named(request.dictionary.as_deref().unwrap_or(Definition::DICTIONARY))?;
            let marker_mm = marker_mm(request, Definition::MARKER_SHARE)?;
            check_count(columns * rows / 2, dictionary.name(), dictionary.count())?;
            let modules = dictionary.marker(0).map_or(1, Modules::side);
            printable(marker_mm / modules as f64)?;
            Definition::Charuco {
                squares,
                square_mm,
                marker_mm,
                dictionary: dictionary.name().to_owned(),
                legacy_layout: false,
            }
        }
        BoardKind::Chessboard => {
            let board = "a chessboard";
            if request.marker_mm.is_some() {
                return Err(BoardError::MarkerSizeUnused { board });
            }
            without_dictionary(board)?;
            printable(square_mm)?;
            Definition::Chessboard {
                squares,
                inner_corners: squares.map(|n| n - 1),
                square_mm,
            }
        }
        BoardKind::Aprilgrid => {
            without_dictionary("an AprilGrid, which is made of tag36h11")?;
            let tag_mm = marker_mm(request, 1.0 / (1.0 + Definition::TAG_SPACING))?;
            check_count(columns * rows, "tag36h11", TagFamily::Tag36h11.count() as usize)?;
            printable(tag_mm / f64::from(Definition::GRID_TAG_MODULES))?;
            Definition::Aprilgrid {
                tags: squares,
                tag_mm,
                // Rounded as the file shows it (a millionth of a tag), so that the board and its file agree.
                tag_spacing: ((square_mm / tag_mm - 1.0) * 1e6).round() / 1e6,
                family: "tag36h11".to_owned(),
                border_modules: 2,
            }
        }
    })
}

fn check_count(needed: u32, dictionary: &'static str, count: usize) -> Result<(), BoardError> {
    let needed = needed as usize;
    if needed > count {
        return Err(BoardError::NotEnoughMarkers {
            needed,
            dictionary,
            count,
        });
    }
    Ok(())
}

/// Returns the marker's size, requested or usual, rounded to thousandths of a millimetre.
fn marker_mm(request: &BoardRequest, usual_share: f64) -> Result<f64, BoardError> {
    let usual = (request.square_mm * usual_share * 1000.0).round() / 1000.0;
    let marker_mm = length::size_mm("marker", request.marker_mm.unwrap_or(usual))?;
    if marker_mm >= 0.95 * request.square_mm {
        return Err(BoardError::MarkerTooLarge {
            marker_mm,
            square_mm: request.square_mm,
        });
    }
    Ok(marker_mm)
}

fn printable(module_mm: f64) -> Result<(), BoardError> {
    if module_mm < MIN_MODULE_MM {
        return Err(BoardError::ModuleTooSmall { module_mm });
    }
    Ok(())
}

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
    let corner = [area.left_mm, area.top_mm];
    let marks = vec![Mark::black(draw::black(&definition, corner)?)];
    let captions = captions(&definition, &media);
    let sheet = page.labelled(page.printable, marks, &captions, definition.name());
    Ok(Board {
        definition,
        area,
        sheet,
    })
}

fn captions(definition: &Definition, media: &Media) -> Vec<String> {
    let print = "Print at 100 % (no fit to page): both rulers must measure 100 mm.";
    let glue = "Glue the sheet to something flat and stiff; a board that bends spoils a calibration.";
    let lines = [print, glue, &definition.line(), &making(media)];
    lines.map(str::to_owned).to_vec()
}
