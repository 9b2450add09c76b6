//! Letters: one for each seam between two sheets, so that a person finds what meets what.

use super::layout::{SheetLayout, letters};

/// The letters of the seams around a sheet; the neighbour beyond has the same one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetSeams {
    pub left: Option<String>,
    pub right: Option<String>,
    pub above: Option<String>,
    pub below: Option<String>,
}

impl SheetLayout {
    /// Seams are lettered row by row: those between the sheets of a row, then those to the row below.
    pub fn seams(&self, row: usize, column: usize) -> SheetSeams {
        let row_starts = |row: usize| row * (2 * self.columns - 1);
        let right_of = |row: usize, column: usize| letters(row_starts(row) + column);
        let below = |row: usize, column: usize| letters(row_starts(row) + self.columns - 1 + column);
        SheetSeams {
            left: (column > 0 && self.has(row, column - 1)).then(|| right_of(row, column - 1)),
            right: self.has(row, column + 1).then(|| right_of(row, column)),
            above: (row > 0 && self.has(row - 1, column)).then(|| below(row - 1, column)),
            below: self.has(row + 1, column).then(|| below(row, column)),
        }
    }
}
