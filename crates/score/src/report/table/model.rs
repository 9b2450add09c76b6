//! A table of a report, put together once and written in every form: for the terminal, LaTeX, HTML, CSV and JSON.

use crate::report::table::Cell;

/// Rows of typed cells below named columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Caption.
    pub caption: String,
    pub columns: Vec<Column>,
    /// Rows that belong together; a line separates two blocks. Each row has a cell for each column.
    pub blocks: Vec<Vec<Vec<Cell>>>,
    /// Notes on the cells.
    pub notes: Vec<String>,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Heading for people.
    pub title: String,
    /// Name for programs: `hit_rate`.
    pub key: String,
    /// Unit of its numbers, where they have one: `95 %` of an interval, `mm`.
    pub unit: Option<&'static str>,
    pub alignment: Alignment,
}

/// Alignment of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    Left,
    Right,
}

impl Column {
    /// Makes a column of words, aligned left.
    pub fn words(title: &str) -> Column {
        Column {
            title: title.to_owned(),
            key: key_of(title),
            unit: None,
            alignment: Alignment::Left,
        }
    }

    /// Makes a column of numbers, aligned right.
    pub fn numbers(title: &str) -> Column {
        Column {
            alignment: Alignment::Right,
            ..Column::words(title)
        }
    }

    pub fn called(self, key: &str) -> Column {
        let key = key.to_owned();
        Column { key, ..self }
    }

    pub fn in_unit(self, unit: &'static str) -> Column {
        let unit = Some(unit);
        Column { unit, ..self }
    }

    /// Returns the title with its unit: `drop [95 %]`.
    pub(crate) fn heading(&self) -> String {
        match self.unit {
            None => self.title.clone(),
            Some(unit) => format!("{} [{unit}]", self.title),
        }
    }
}

/// Returns the key of a title: `mean_confidence` for `mean confidence`.
fn key_of(title: &str) -> String {
    let letters = title.to_lowercase();
    let words = letters
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

impl Table {
    pub fn new(caption: &str, columns: Vec<Column>) -> Table {
        Table {
            caption: caption.to_owned(),
            columns,
            blocks: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Adds rows that belong together. A text that the first column repeats from the row above is written once.
    pub fn add_block(&mut self, rows: impl IntoIterator<Item = Vec<Cell>>) {
        let mut rows: Vec<Vec<Cell>> = rows.into_iter().collect();
        for i in (1..rows.len()).rev() {
            if rows[i].first() == rows[i - 1].first() {
                rows[i][0].is_repeated = true;
            }
        }
        self.blocks.push(rows);
    }

    pub(crate) fn rows(&self) -> impl Iterator<Item = &Vec<Cell>> {
        self.blocks.iter().flatten()
    }
}
