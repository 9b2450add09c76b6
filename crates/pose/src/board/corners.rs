//! Where the corners that a detector names lie on the board.

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
    /// The corners a calibration uses, by their number: the inner corners of a chessboard or ChArUco board row by row from the
    /// upper left (OpenCV's numbering), of an AprilGrid the four corners of tag 0 (upper left, then clockwise), of tag 1, ….
    pub fn corners_mm(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Charuco { squares, square_mm, .. } | Self::Chessboard { squares, square_mm, .. } => {
                let [columns, rows] = *squares;
                (1..rows)
                    .flat_map(|row| (1..columns).map(move |column| (column, row)))
                    .map(|(column, row)| [f64::from(column) * square_mm, f64::from(row) * square_mm])
                    .collect()
            }
            Self::Aprilgrid { .. } => self.markers().iter().flat_map(|m| m.corners_mm).collect(),
        }
    }

    /// The markers of a ChArUco board or the tags of an AprilGrid, by id from 0 up; a chessboard has none.
    pub fn markers(&self) -> Vec<Marker> {
        match self {
            Self::Chessboard { .. } => Vec::new(),
            Self::Charuco {
                squares,
                square_mm,
                marker_mm,
                ..
            } => {
                let [columns, rows] = *squares;
                let inset = (square_mm - marker_mm) / 2.0;
                (0..rows)
                    .flat_map(|row| (0..columns).map(move |column| (column, row)))
                    .filter(|(column, row)| (column + row) % 2 == 1)
                    .zip(0..)
                    .map(|((column, row), id)| {
                        let at = |n: u32| f64::from(n) * square_mm + inset;
                        Marker::new(id, [at(column), at(row)], *marker_mm)
                    })
                    .collect()
            }
            Self::Aprilgrid {
                tags,
                tag_mm,
                tag_spacing,
                ..
            } => {
                let ([columns, rows], gap) = (*tags, tag_mm * tag_spacing);
                (0..rows)
                    .flat_map(|up| (0..columns).map(move |column| (column, rows - 1 - up)))
                    .zip(0..)
                    .map(|((column, row), id)| {
                        let at = |n: u32| gap + f64::from(n) * (tag_mm + gap);
                        Marker::new(id, [at(column), at(row)], *tag_mm)
                    })
                    .collect()
            }
        }
    }
}

impl Marker {
    fn new(id: u32, [x, y]: [f64; 2], side: f64) -> Self {
        Self {
            id,
            corners_mm: [[x, y], [x + side, y], [x + side, y + side], [x, y + side]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_markers_lie_where_they_are_printed() {
        let charuco = Definition::Charuco {
            squares: [9, 7],
            square_mm: 22.0,
            marker_mm: 16.0,
            dictionary: "DICT_5X5_100".into(),
            legacy_layout: false,
        };
        assert_eq!(charuco.corners_mm().len(), 48);
        assert_eq!(
            charuco.corners_mm()[8],
            [22.0, 44.0],
            "the second row starts with corner 8"
        );
        assert_eq!(charuco.markers().len(), 31);
        // The upper left square is black, so marker 0 stands in the second.
        assert_eq!(charuco.markers()[0].corners_mm[2], [41.0, 19.0]);
        let grid = Definition::Aprilgrid {
            tags: [6, 5],
            tag_mm: 20.0,
            tag_spacing: 0.3,
            family: "tag36h11".into(),
            border_modules: 2,
        };
        assert_eq!(grid.corners_mm().len(), 120);
        let [x, y] = grid.corners_mm()[3];
        assert!(
            (x - 6.0).abs() < 1e-9 && (y - 130.0).abs() < 1e-9,
            "tag 0 is at the bottom left"
        );
    }
}
