//! Positions of a board's calibration corners and markers, in the board frame.

use std::ops::Range;

use super::Definition;

/// A square of modules on the board: a ChArUco marker or a tag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Marker {
    pub id: u32,
    /// Upper left, upper right, lower right, lower left of the upright board (board frame, mm).
    pub corners_mm: [[f64; 2]; 4],
}

/// Board frame: origin at the board's upper left corner, x right, y down, in mm; the board is the plane z = 0.
impl Definition {
    /// Returns the corners a calibration uses, by their number: the inner corners of a chessboard or ChArUco board row by row from the
    /// upper left (OpenCV's numbering), of an AprilGrid the four corners of tag 0 (upper left, then clockwise), of tag 1, ….
    pub fn corners_mm(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Charuco { squares, square_mm, .. } | Self::Chessboard { squares, square_mm, .. } => {
                let [columns, rows] = *squares;
                let corner = |at: [u32; 2]| at.map(|n| f64::from(n) * square_mm);
                row_by_row(1..columns, 1..rows).map(corner).collect()
            }
            Self::Aprilgrid { .. } => self.markers().iter().flat_map(|m| m.corners_mm).collect(),
        }
    }

    /// Returns the markers of a ChArUco board or the tags of an AprilGrid, by id from 0 up; a chessboard has none.
    pub fn markers(&self) -> Vec<Marker> {
        // Columns and rows of the markers, their side, the offset of the first one and the step from one to the next, mm.
        let (places, side, first, step): (Vec<[u32; 2]>, f64, f64, f64) = match self {
            Self::Chessboard { .. } => return Vec::new(),
            Self::Charuco {
                squares: [columns, rows],
                square_mm,
                marker_mm,
                legacy_layout,
                ..
            } => {
                // OpenCV 4.13, `CharucoBoardImpl::createCharucoBoard`.
                let first_is_white = *legacy_layout && rows.is_multiple_of(2);
                let is_white = |[column, row]: &[u32; 2]| (column + row + u32::from(first_is_white)) % 2 == 1;
                let white = row_by_row(0..*columns, 0..*rows).filter(is_white);
                (white.collect(), *marker_mm, (square_mm - marker_mm) / 2.0, *square_mm)
            }
            Self::Aprilgrid {
                tags: [columns, rows],
                tag_mm,
                tag_spacing,
                ..
            } => {
                let (gap, upwards) = (tag_mm * tag_spacing, row_by_row(0..*columns, 0..*rows));
                let places = upwards.map(|[column, up]| [column, rows - 1 - up]);
                (places.collect(), *tag_mm, gap, tag_mm + gap)
            }
        };
        let marker = |(id, place): (u32, [u32; 2])| {
            let [x, y] = place.map(|n| f64::from(n) * step + first);
            Marker {
                id,
                corners_mm: [[x, y], [x + side, y], [x + side, y + side], [x, y + side]],
            }
        };
        (0..).zip(places).map(marker).collect()
    }
}

fn row_by_row(columns: Range<u32>, rows: Range<u32>) -> impl Iterator<Item = [u32; 2]> {
    rows.flat_map(move |row| columns.clone().map(move |column| [column, row]))
}
