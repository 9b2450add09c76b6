//! A table as wide as a screen.

use crate::report::table::Table;

/// Number of letters that fit on a line of a screen.
const LETTERS: usize = 100;

/// Returns the lines of a table with its notes, as wide as a screen.
pub(crate) fn on_screen(table: &Table) -> Vec<String> {
    let mut lines = table.lines_within(LETTERS);
    lines.extend(table.notes.iter().cloned());
    lines
}
