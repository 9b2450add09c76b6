//! File that describes a board, for the programs that detect it.

use std::path::Path;

use serde::{Deserialize, Serialize};

use scaleproof_core::files;
use scaleproof_core::geometry::length::{self, number};
use scaleproof_core::message::{Message, bail, message};

/// A board by the numbers a detector needs. Lengths in mm; (columns, rows).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub enum Definition {
    /// OpenCV 4.6's layout: the top left square is black, markers stand in the white squares, row by row from the top left.
    Charuco {
        squares: [u32; 2],
        square_mm: f64,
        /// Outer edge of a marker's black border.
        marker_mm: f64,
        dictionary: String,
        /// OpenCV's layout before 4.6, `setLegacyPattern(true)`: with an even number of rows, the top left square is white.
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
        /// Outer edge of a tag's black border: Kalibr's `tagSize`, there in metres.
        tag_mm: f64,
        /// The gap between two tags by the tag's size: Kalibr's `tagSpacing`.
        tag_spacing: f64,
        family: String,
        /// Kalibr draws the black border two modules wide.
        border_modules: u32,
    },
}

impl Definition {
    /// The default dictionary of a ChArUco board.
    pub const DICTIONARY: &'static str = "DICT_5X5_100";
    /// A ChArUco marker's share of its square.
    pub const MARKER_SHARE: f64 = 0.75;
    /// The gap of Kalibr's own grids, by the tag's size.
    pub const TAG_SPACING: f64 = 0.3;
    /// Maximum number of columns or rows; more are a mistake in the numbers.
    pub const MOST_SQUARES: u32 = 100;
    /// Modules of a Kalibr tag: 6 of code, 2 of border on each side.
    pub const GRID_TAG_MODULES: u32 = 10;
    /// Maximum width of a border, in modules; wider ones leave no code in a tag.
    const MOST_BORDER_MODULES: u32 = 4;

    pub fn open(path: &Path) -> Result<Self, Message> {
        let text = files::read_text(path).map_err(|e| message!("{e}"))?;
        let refuse = |fault| {
            message!(
                "{path} is no board file ({fault}): use the .toml that `print board` wrote, or one of calibration/",
                path = path.display()
            )
        };
        let syntax = |e: toml::de::Error| message!("{}", e.message().trim().replace('\n', " "));
        let definition: Self = toml::from_str(&text).map_err(|e| refuse(syntax(e)))?;
        definition.checked().map_err(refuse)
    }

    fn checked(self) -> Result<Self, Message> {
        let (lengths, counts, least) = match &self {
            Self::Charuco {
                square_mm, marker_mm, ..
            } if marker_mm >= square_mm => bail!("marker_mm must be below square_mm"),
            Self::Charuco {
                squares,
                square_mm,
                marker_mm,
                ..
            } => (vec![("square_mm", *square_mm), ("marker_mm", *marker_mm)], squares, 3),
            Self::Chessboard {
                squares,
                inner_corners,
                square_mm,
            } => {
                if *inner_corners != squares.map(|n| n.saturating_sub(1)) {
                    bail!("inner_corners must be one below squares each way");
                }
                (vec![("square_mm", *square_mm)], squares, 3)
            }
            Self::Aprilgrid { family, .. } if family != "tag36h11" => {
                bail!("family {} is not supported, only tag36h11", family)
            }
            Self::Aprilgrid { border_modules, .. } if !(1..=Self::MOST_BORDER_MODULES).contains(border_modules) => {
                bail!("border_modules must be 1 to {}", Definition::MOST_BORDER_MODULES);
            }
            Self::Aprilgrid {
                tags,
                tag_mm,
                tag_spacing,
                ..
            } => {
                let gap = ("tag_mm times tag_spacing", tag_mm * tag_spacing);
                (vec![("tag_mm", *tag_mm), gap], tags, 1)
            }
        };
        for (what, value) in lengths {
            length::size_mm(what, value)?;
        }
        if counts.iter().any(|n| !(least..=Self::MOST_SQUARES).contains(n)) {
            bail!(
                "it must have {least} to {most} columns and rows",
                most = Definition::MOST_SQUARES
            );
        }
        Ok(self)
    }

    /// Returns width and height of the whole print, mm.
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

    pub fn name(&self) -> &'static str {
        match self {
            Self::Charuco { .. } => "ChArUco",
            Self::Chessboard { .. } => "chessboard",
            Self::Aprilgrid { .. } => "AprilGrid",
        }
    }

    pub fn line(&self) -> String {
        match self {
            Self::Charuco {
                squares: [x, y],
                square_mm,
                marker_mm,
                dictionary,
                legacy_layout,
            } => format!(
                "ChArUco · {x}×{y} squares of {} mm · markers of {} mm · {dictionary} · {} layout",
                number(*square_mm),
                number(*marker_mm),
                if *legacy_layout { "legacy OpenCV" } else { "OpenCV 4.6" }
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

    /// Returns the text of the definition file.
    ///
    /// # Errors
    /// Only if the TOML library fails.
    pub fn to_toml(&self) -> Result<String, Message> {
        let fields = toml::to_string(self).map_err(|e| message!("the definition could not be put together: {}", e))?;
        Ok(format!(
            "# {}\n# Lengths in mm; columns, rows. Written by `scaleproof print board`.\n{fields}",
            self.line()
        ))
    }
}
