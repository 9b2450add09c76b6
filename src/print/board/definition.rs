//! What a board is: the file that is written beside it, for whoever detects it.

use serde::{Deserialize, Serialize};

use super::{BoardError, BoardKind, BoardRequest, MIN_MODULE_MM, MOST_SQUARES};
use crate::print::PrintError;
use crate::print::lettering::number;
use crate::tags::MarkerDictionary;

/// A board by the numbers a detector needs. Lengths in mm; (columns, rows).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub enum Definition {
    /// OpenCV 4.6's layout: the top left square is black, markers stand in the white squares, row by row from the top left.
    Charuco {
        squares: [u32; 2],
        square_mm: f64,
        /// Outer edge of a marker's black border.
        marker_mm: f64,
        dictionary: String,
        /// Always false: OpenCV's layout before 4.6, `setLegacyPattern(true)`.
        legacy_layout: bool,
    },
    /// The top left square is black.
    Chessboard {
        squares: [u32; 2],
        /// OpenCV's pattern size.
        inner_corners: [u32; 2],
        square_mm: f64,
    },
    /// Kalibr's layout: ids row by row from the bottom left, black squares in the corners between tags.
    Aprilgrid {
        tags: [u32; 2],
        /// Outer edge of a tag's black border: Kalibr's `tagSize`, which it wants in metres.
        tag_mm: f64,
        /// The gap between two tags by the tag's size: Kalibr's `tagSpacing`.
        tag_spacing: f64,
        family: String,
        /// Kalibr draws the black border two modules wide.
        border_modules: u32,
    },
}

impl Definition {
    /// The dictionary of a ChArUco board unless another is asked for.
    pub const DICTIONARY: &'static str = "DICT_5X5_100";
    /// A ChArUco marker's share of its square.
    const MARKER_SHARE: f64 = 0.75;
    /// The gap of Kalibr's own grids, by the tag's size.
    const TAG_SPACING: f64 = 0.3;
    /// Modules of a Kalibr tag: 6 of code, 2 of border on each side.
    pub const GRID_TAG_MODULES: u32 = 10;

    /// The definition of a board that can be printed.
    pub(super) fn of(request: &BoardRequest) -> Result<Self, BoardError> {
        let (columns, rows) = request.squares;
        let least = if request.kind == BoardKind::Aprilgrid { 1 } else { 3 };
        if !(least..=MOST_SQUARES).contains(&columns) || !(least..=MOST_SQUARES).contains(&rows) {
            return Err(BoardError::Squares { columns, rows, least });
        }
        positive("square", request.square_mm)?;
        match request.kind {
            BoardKind::Charuco => charuco(request),
            BoardKind::Chessboard => chessboard(request),
            BoardKind::Aprilgrid => aprilgrid(request),
        }
    }

    /// Width and height of everything printed.
    pub fn size_mm(&self) -> (f64, f64) {
        match self {
            Self::Charuco { squares, square_mm, .. } | Self::Chessboard { squares, square_mm, .. } => {
                (f64::from(squares[0]) * square_mm, f64::from(squares[1]) * square_mm)
            }
            Self::Aprilgrid {
                tags,
                tag_mm,
                tag_spacing,
                ..
            } => {
                let along = |n: u32| tag_mm * (f64::from(n) * (1.0 + tag_spacing) + tag_spacing);
                (along(tags[0]), along(tags[1]))
            }
        }
    }

    /// What people call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Charuco { .. } => "ChArUco",
            Self::Chessboard { .. } => "chessboard",
            Self::Aprilgrid { .. } => "AprilGrid",
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        match self {
            Self::Charuco {
                squares: [x, y],
                square_mm,
                marker_mm,
                dictionary,
                ..
            } => format!(
                "ChArUco · {x}×{y} squares of {} mm · markers of {} mm · {dictionary} · OpenCV 4.6 layout",
                number(*square_mm),
                number(*marker_mm)
            ),
            Self::Chessboard {
                squares: [x, y],
                inner_corners: [across, down],
                square_mm,
            } => format!(
                "chessboard · {x}×{y} squares of {} mm · {across}×{down} inner corners",
                number(*square_mm)
            ),
            Self::Aprilgrid {
                tags: [x, y],
                tag_mm,
                tag_spacing,
                family,
                ..
            } => format!(
                "AprilGrid (Kalibr) · {x}×{y} tags of {} mm · spacing {} · {family}",
                number(*tag_mm),
                number(*tag_spacing)
            ),
        }
    }

    /// The definition file.
    ///
    /// # Errors
    /// Only if the TOML library fails.
    pub fn to_toml(&self) -> Result<String, BoardError> {
        let fields = toml::to_string(self).map_err(|e| BoardError::Definition { reason: e.to_string() })?;
        Ok(format!(
            "# {}\n# Lengths in mm; columns, rows. Written by `scaleproof print board`.\n{fields}",
            self.line()
        ))
    }
}

fn charuco(request: &BoardRequest) -> Result<Definition, BoardError> {
    let dictionary = MarkerDictionary::named(request.dictionary.as_deref().unwrap_or(Definition::DICTIONARY))?;
    let marker_mm = marker_mm(request, Definition::MARKER_SHARE)?;
    let (columns, rows) = request.squares;
    let needed = (columns * rows / 2) as usize;
    if needed > dictionary.count() {
        return Err(BoardError::NotEnoughMarkers {
            needed,
            dictionary: dictionary.name(),
            count: dictionary.count(),
        });
    }
    let modules = dictionary.marker(0).map_or(1, crate::tags::Modules::side);
    printable(marker_mm / modules as f64)?;
    Ok(Definition::Charuco {
        squares: [columns, rows],
        square_mm: request.square_mm,
        marker_mm,
        dictionary: dictionary.name().to_owned(),
        legacy_layout: false,
    })
}

fn chessboard(request: &BoardRequest) -> Result<Definition, BoardError> {
    let not_here = |option| BoardError::NotForThisBoard {
        option,
        board: "a chessboard",
    };
    if request.marker_mm.is_some() {
        return Err(not_here("--marker-mm"));
    }
    if request.dictionary.is_some() {
        return Err(not_here("--dictionary"));
    }
    printable(request.square_mm)?;
    let (columns, rows) = request.squares;
    Ok(Definition::Chessboard {
        squares: [columns, rows],
        inner_corners: [columns - 1, rows - 1],
        square_mm: request.square_mm,
    })
}

fn aprilgrid(request: &BoardRequest) -> Result<Definition, BoardError> {
    if request.dictionary.is_some() {
        return Err(BoardError::NotForThisBoard {
            option: "--dictionary",
            board: "an AprilGrid, which is made of tag36h11",
        });
    }
    let tag_mm = marker_mm(request, 1.0 / (1.0 + Definition::TAG_SPACING))?;
    let (columns, rows) = request.squares;
    let (needed, count) = (
        (columns * rows) as usize,
        crate::scene::TagFamily::Tag36h11.count() as usize,
    );
    if needed > count {
        return Err(BoardError::NotEnoughMarkers {
            needed,
            dictionary: "tag36h11",
            count,
        });
    }
    printable(tag_mm / f64::from(Definition::GRID_TAG_MODULES))?;
    Ok(Definition::Aprilgrid {
        tags: [columns, rows],
        tag_mm,
        // Rounded to what the file shows, so that the board and its file agree: a millionth of a tag.
        tag_spacing: ((request.square_mm / tag_mm - 1.0) * 1e6).round() / 1e6,
        family: "tag36h11".to_owned(),
        border_modules: 2,
    })
}

/// The marker's size, asked for or usual, in thousandths of a millimetre.
fn marker_mm(request: &BoardRequest, usual_share: f64) -> Result<f64, BoardError> {
    let usual = (request.square_mm * usual_share * 1000.0).round() / 1000.0;
    let marker_mm = request.marker_mm.unwrap_or(usual);
    positive("marker", marker_mm)?;
    if marker_mm >= 0.95 * request.square_mm {
        return Err(BoardError::MarkerTooLarge {
            marker_mm,
            square_mm: request.square_mm,
        });
    }
    Ok(marker_mm)
}

fn positive(what: &'static str, value: f64) -> Result<(), PrintError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let wanted = "a side above 0 mm";
    Err(PrintError::BadNumber { what, value, wanted })
}

fn printable(module_mm: f64) -> Result<(), BoardError> {
    if module_mm < MIN_MODULE_MM {
        return Err(BoardError::ModuleTooSmall { module_mm });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_comes_back_as_it_was() {
        let request = BoardRequest {
            kind: BoardKind::Aprilgrid,
            squares: (6, 5),
            square_mm: 26.0,
            marker_mm: None,
            dictionary: None,
            media: crate::print::page::Media {
                paper: crate::print::paper::Paper::A4,
                printer: crate::print::printer::Printer::EXACT,
            },
        };
        for kind in [BoardKind::Aprilgrid, BoardKind::Charuco, BoardKind::Chessboard] {
            let definition = Definition::of(&BoardRequest {
                kind,
                ..request.clone()
            })
            .unwrap();
            let text = definition.to_toml().unwrap();
            assert_eq!(toml::from_str::<Definition>(&text).unwrap(), definition, "{text}");
        }
    }
}
