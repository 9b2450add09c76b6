//! A table as a `tabular` in booktabs' style.

use crate::report::latex::markup::{escaped, number, row, tabular};
use crate::report::table::{Alignment, Cell, Table, Value};

impl Table {
    /// Returns the `tabular` alone, without caption and notes.
    pub fn tex(&self) -> String {
        let columns: String = (0..self.columns.len()).map(|column| self.letter(column)).collect();
        let head = row(self
            .columns
            .iter()
            .map(|column| tex_heading(&column.title, column.unit)));
        let blocks = self.blocks.iter().filter(|block| !block.is_empty());
        let blocks = blocks.map(|block| block.iter().map(|cells| row(cells.iter().map(Cell::tex))).collect());
        tabular(&columns, std::iter::once(vec![head]).chain(blocks))
    }

    /// Returns the alignment of a column: numbers with an interval begin at the left, so that their points stand below each other.
    fn letter(&self, column: usize) -> char {
        let mut cells = self.rows().filter_map(|row| row.get(column));
        match self.columns[column].alignment {
            Alignment::Right if !cells.any(|cell| cell.interval.is_some()) => 'r',
            _ => 'l',
        }
    }
}

/// Returns a heading with its unit: `Drop, 95\,\%`.
fn tex_heading(title: &str, unit: Option<&str>) -> String {
    let unit = unit.map(|unit| format!(", {}", escaped(unit).replace(' ', "\\,")));
    escaped(title) + &unit.unwrap_or_default()
}

impl Cell {
    /// Returns the cell in TeX: bold where a change is shown; with a remark, a double dagger.
    pub fn tex(&self) -> String {
        if self.is_repeated || self.value == Value::None {
            return String::new();
        }
        let words = match &self.value {
            Value::Text(text) => escaped(text),
            _ => self.words(number).replace('→', "$\\to$"),
        };
        let words = if self.is_strong {
            format!("\\textbf{{{words}}}")
        } else {
            words
        };
        let dagger = if self.remark.is_some() { "$^\\ddagger$" } else { "" };
        let interval = self.interval_words(number).map(|interval| format!(" {interval}"));
        format!("{words}{dagger}{}", interval.unwrap_or_default())
    }
}
