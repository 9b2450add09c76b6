//! The table of a run's protocol as files and as text: `protocol.csv` and `protocol.tex`.

use super::ReportError;
use super::latex::escaped;
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

/// What they are called.
pub(super) const NAMES: [&str; 2] = ["protocol.csv", "protocol.tex"];

fn csv(table: &ProtocolTable) -> Result<String, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    for row in [&table.columns].into_iter().chain(&table.rows) {
        writer.write_record(row)?;
    }
    let text = writer.into_inner().map_err(|e| ::csv::Error::from(e.into_error()))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// `photos: 8 normal, 8 random`: what the figures rest on, which not every paper's table has a column for.
pub(super) fn photos(scores: &Scores) -> String {
    let first = scores.summaries.chunk_by(|a, b| a.detector == b.detector).next();
    let counts = first.unwrap_or_default().iter();
    let counts: Vec<String> = counts.map(|s| format!("{} {}", s.overall.photos, s.variant)).collect();
    format!("photos: {}", counts.join(", "))
}

fn tex(table: &ProtocolTable, photos: &str) -> String {
    let row = |cells: &Vec<String>| {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        format!("{} \\\\", cells.join(" & "))
    };
    let mut lines = vec![
        format!(
            "% scaleproof {}, protocol {}. Needs \\usepackage{{booktabs}}.\n% {}.\n% {}.",
            env!("CARGO_PKG_VERSION"),
            table.name,
            table.source,
            photos.replace(char::is_control, " ")
        ),
        format!(
            "\\begin{{tabular}}{{l{}}}",
            "r".repeat(table.columns.len().saturating_sub(1))
        ),
        "\\toprule".to_owned(),
        row(&table.columns),
        "\\midrule".to_owned(),
    ];
    lines.extend(table.rows.iter().map(row));
    lines.extend(["\\bottomrule".to_owned(), "\\end{tabular}\n".to_owned()]);
    lines.join("\n")
}

/// The table for the terminal, with its source above it.
pub(super) fn lines(scores: &Scores, table: &ProtocolTable) -> Vec<String> {
    let rows: Vec<&Vec<String>> = [&table.columns].into_iter().chain(&table.rows).collect();
    let head = format!("protocol {}: {}; {}", table.name, table.source, photos(scores));
    [head].into_iter().chain(aligned(&rows)).collect()
}

/// Rows whose columns stand below each other.
pub(super) fn aligned(rows: &[&Vec<String>]) -> Vec<String> {
    let wide = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or_default()
    };
    let line = |row: &&Vec<String>| {
        let cells = row
            .iter()
            .enumerate()
            .map(|(i, cell)| format!("{cell:<width$}", width = wide(i)));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}
