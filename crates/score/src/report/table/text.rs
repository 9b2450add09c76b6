//! A table in lines of plain text.

use crate::report::table::{Alignment, Cell, Table, Value};

/// Number of columns that a screen always has.
const FEWEST: usize = 4;

/// Number of letters of a name on a screen.
const NAME: usize = 22;

impl Cell {
    /// Takes letters out of the middle of a long name: of names that differ at either end both ends are kept.
    fn shorten(&mut self) {
        let Value::Text(name) = &mut self.value else { return };
        let letters: Vec<char> = name.chars().collect();
        if letters.len() > NAME {
            let (first, last) = (NAME / 2, NAME - NAME / 2 - 1);
            let kept = letters[..first]
                .iter()
                .chain(['…'].iter())
                .chain(&letters[letters.len() - last..]);
            *name = kept.collect();
        }
    }
}

impl Table {
    /// Returns the headings, then a line for each row, its columns two spaces apart.
    pub fn lines(&self) -> Vec<String> {
        let head = self.columns.iter().map(|column| column.heading()).collect();
        let rows = self.rows().map(|row| row.iter().map(Cell::line).collect());
        let rows: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
        let is_right: Vec<bool> = (0..self.columns.len())
            .map(|column| self.is_right_aligned(column))
            .collect();
        let widths: Vec<usize> = (0..self.columns.len()).map(|column| width(&rows, column)).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).zip(&is_right);
            let cells = cells.map(|((cell, &width), is_right)| match is_right {
                true => format!("{cell:>width$}"),
                false => format!("{cell:<width$}"),
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        };
        rows.iter().map(line).collect()
    }

    /// Returns the caption, the lines however wide, and the notes.
    pub fn described(&self) -> Vec<String> {
        let lines = std::iter::once(self.caption.clone()).chain(self.lines());
        lines.chain(self.notes.iter().cloned()).collect()
    }

    /// Returns lines of at most `letters` letters: long names in the first two columns are shortened in their middle, and the last columns are left
    /// out where they have no room, but never the first four.
    pub fn lines_within(&self, letters: usize) -> Vec<String> {
        let mut narrow = self.clone();
        for row in narrow.blocks.iter_mut().flatten() {
            row.iter_mut().take(2).for_each(Cell::shorten);
        }
        loop {
            let lines = narrow.lines();
            let is_wider = lines.iter().any(|line| line.chars().count() > letters);
            if !is_wider || narrow.columns.len() <= FEWEST {
                return lines;
            }
            narrow.columns.pop();
            narrow.blocks.iter_mut().flatten().for_each(|row| {
                row.pop();
            });
        }
    }

    /// Returns true if a column is aligned right: numbers alone are; beside intervals or remarks they begin at the left.
    fn is_right_aligned(&self, column: usize) -> bool {
        let has_more = |cell: &Cell| cell.interval.is_some() || cell.remark.is_some();
        let cells = self.rows().filter_map(|row| row.get(column));
        self.columns[column].alignment == Alignment::Right && !cells.into_iter().any(has_more)
    }
}

fn width(rows: &[Vec<String>], column: usize) -> usize {
    let cells = rows.iter().filter_map(|row| row.get(column));
    cells.map(|cell| cell.chars().count()).max().unwrap_or_default()
}
