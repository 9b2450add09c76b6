//! Differences between variants on defended photos: `defences.csv`, and `defences.tex` for a paper.

use serde_json::json;

use crate::figures::{Defences, Scores};
use crate::report::robustness::columns;
use crate::report::{ReportError, counted, csv_of, tables};

pub(super) const NAMES: [&str; 2] = ["defences.csv", "defences.tex"];

/// Returns names and contents of the files; none for a run without defences.
pub(super) fn files(scores: &Scores) -> Result<Vec<(String, String)>, ReportError> {
    let Some(defences) = &scores.defences else {
        return Ok(Vec::new());
    };
    let rows = [("drop", &defences.rows), ("change", &defences.changes)];
    let rows = rows
        .into_iter()
        .flat_map(|(what, rows)| rows.iter().map(move |row| (what, row)));
    let csv = csv_of(rows.map(|(what, row)| {
        let mut line = vec![("of", json!(what)), ("defence", json!(row.defence))];
        line.extend(columns(scores, &row.held));
        line
    }))?;
    Ok(vec![
        (NAMES[0].to_owned(), csv),
        (NAMES[1].to_owned(), tex(scores, defences)),
    ])
}

/// Returns both tables in TeX, below a comment that describes the defences.
fn tex(scores: &Scores, defences: &Defences) -> String {
    let cards = defences
        .defences
        .iter()
        .map(|d| format!("% {}: {} ({})", d.name, d.does, d.source));
    let cards: String = cards.map(|card| one_line(&card) + "\n").collect();
    let tables = tables::defended(defences).map(|table| format!("% {}.\n{}", one_line(&table.caption), table.tex()));
    let counted = one_line(&counted::counted(scores));
    format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}. Counts as the model: {counted}.\n{cards}{}",
        env!("CARGO_PKG_VERSION"),
        scores.criteria.ap.name(),
        tables.join("\n")
    )
}

/// Replaces control characters by spaces, so that a text is one line of a comment.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
