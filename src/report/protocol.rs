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
        (NAMES[1].to_owned(), tex(&table)),
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

fn tex(table: &ProtocolTable) -> String {
    let row = |cells: &Vec<String>| {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        format!("{} \\\\", cells.join(" & "))
    };
    let mut lines = vec![
        format!(
            "% scaleproof {}, protocol {}. Needs \\usepackage{{booktabs}}.\n% {}.",
            env!("CARGO_PKG_VERSION"),
            table.name,
            table.source
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
pub(super) fn lines(table: &ProtocolTable) -> Vec<String> {
    let rows: Vec<&Vec<String>> = [&table.columns].into_iter().chain(&table.rows).collect();
    let head = format!("protocol {}: {}", table.name, table.source);
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
