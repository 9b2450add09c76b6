//! Table that a protocol's paper prints.

use crate::figures::{ProtocolTable, Scores, protocol_table};
use crate::report::table::{Cell, Column, Table};

/// Returns the table of the run's protocol; `None` when it follows none.
pub(crate) fn protocol(scores: &Scores) -> Option<Table> {
    let ProtocolTable {
        name,
        source,
        columns,
        rows,
    } = protocol_table(scores)?;
    let column = |(i, title): (usize, &String)| match i {
        0 => Column::words(title).called(title),
        _ => Column::numbers(title).called(title),
    };
    let caption = format!("Protocol {name}: {source}; {}", photos(scores));
    let mut table = Table::new(&caption, columns.iter().enumerate().map(column).collect());
    let rows = rows.into_iter().map(|row| row.into_iter().map(Cell::text).collect());
    table.blocks.push(rows.collect());
    Some(table)
}

/// Returns the numbers of photos, `photos: 8 normal, 8 random`, for which not every paper's table has a column.
fn photos(scores: &Scores) -> String {
    let first = scores.summaries.chunk_by(|a, b| a.detector == b.detector).next();
    let counts = first.unwrap_or_default().iter();
    let counts: Vec<String> = counts.map(|s| format!("{} {}", s.overall.photos, s.variant)).collect();
    format!("photos: {}", counts.join(", "))
}
