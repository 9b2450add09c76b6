//! The table of a run's protocol as files and as text: `protocol.csv` and `protocol.tex`.

use serde_json::json;

use super::latex::{escaped, row, tabular};
use super::{ReportError, csv_of};
use crate::score::{ProtocolTable, Scores, protocol_table};

/// Names and contents of the files; none when the run follows no protocol.
pub(super) fn files(scores: &Scores) -> Result<Vec<(String, String)>, ReportError> {
    let Some(table) = protocol_table(scores) else {
        return Ok(Vec::new());
    };
    Ok(vec![
        (NAMES[0].to_owned(), csv(&table)?),
        (NAMES[1].to_owned(), tex(&table, &photos(scores))),
    ])
}

pub(super) const NAMES: [&str; 2] = ["protocol.csv", "protocol.tex"];

fn csv(table: &ProtocolTable) -> Result<String, ReportError> {
    let names = || table.columns.iter().map(String::as_str);
    csv_of(
        table
            .rows
            .iter()
            .map(|row| names().zip(row.iter().map(|cell| json!(cell))).collect()),
    )
}

/// `photos: 8 normal, 8 random`: what the figures rest on, which not every paper's table has a column for.
pub(super) fn photos(scores: &Scores) -> String {
    let first = scores.summaries.chunk_by(|a, b| a.detector == b.detector).next();
    let counts = first.unwrap_or_default().iter();
    let counts: Vec<String> = counts.map(|s| format!("{} {}", s.overall.photos, s.variant)).collect();
    format!("photos: {}", counts.join(", "))
}

fn tex(table: &ProtocolTable, photos: &str) -> String {
    let line = |cells: &Vec<String>| row(cells.iter().map(|cell| escaped(cell)));
    let columns = format!("l{}", "r".repeat(table.columns.len().saturating_sub(1)));
    format!(
        "% scaleproof {}, protocol {}. Needs \\usepackage{{booktabs}}.\n% {}.\n% {}.\n{}",
        env!("CARGO_PKG_VERSION"),
        table.name,
        table.source,
        photos.replace(char::is_control, " "),
        tabular(
            &columns,
            [vec![line(&table.columns)], table.rows.iter().map(line).collect()]
        )
    )
}

/// The table for the terminal, with its source above it.
pub(super) fn lines(scores: &Scores, table: &ProtocolTable) -> Vec<String> {
    let rows: Vec<&Vec<String>> = [&table.columns].into_iter().chain(&table.rows).collect();
    let head = format!("protocol {}: {}; {}", table.name, table.source, photos(scores));
    [head].into_iter().chain(aligned(&rows)).collect()
}

pub(super) fn aligned(rows: &[&Vec<String>]) -> Vec<String> {
    let wide = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or_default()
    };
    let line = |row: &&Vec<String>| {
        let cells = row.iter().enumerate();
        let cells = cells.map(|(i, cell)| format!("{cell:<width$}", width = wide(i)));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}
