//! A request for a board becomes its definition, or a sentence why it cannot be printed.

use super::{BoardError, BoardKind, BoardRequest, Definition, MIN_MODULE_MM};
use scaleproof_core::geometry::length;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::{MarkerDictionary, Modules};

/// The definition of a board that can be printed.
///
/// # Errors
/// Numbers that make no board, too few markers in the dictionary, modules too small to print.
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
                // Rounded to what the file shows, so that the board and its file agree: a millionth of a tag.
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

/// The marker's size, requested or usual, in thousandths of a millimetre.
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
