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

#[cfg(test)]
mod tests {
    use super::super::layout::{layout, tests::request};
    use super::*;

    #[test]
    fn both_sheets_of_a_seam_have_its_letter() {
        let made = layout(&request((600.0, 300.0))).unwrap();
        assert_eq!((made.rows, made.columns), (2, 3));
        let mut seen = std::collections::BTreeMap::<String, usize>::new();
        for sheet in &made.sheets {
            let seams = made.seams(sheet.row, sheet.column);
            assert_eq!(seams.left.is_none(), sheet.column == 0);
            if sheet.column > 0 {
                assert_eq!(seams.left, made.seams(sheet.row, sheet.column - 1).right);
            }
            if sheet.row > 0 {
                assert_eq!(seams.above, made.seams(sheet.row - 1, sheet.column).below);
            }
            for letter in [seams.left, seams.right, seams.above, seams.below]
                .into_iter()
                .flatten()
            {
                *seen.entry(letter).or_default() += 1;
            }
        }
        let expected = "ABCDEFG".chars().map(|c| (c.to_string(), 2));
        assert_eq!(seen, expected.collect());
    }

    #[test]
    fn rows_have_letters() {
        let all: Vec<_> = [0, 1, 25, 26, 51, 52, 399].map(letters).into();
        assert_eq!(all, ["A", "B", "Z", "AA", "AZ", "BA", "OJ"]);
    }
}
