//! What is left of the differences when photos are defended: `defences.csv`, and `defences.tex` for a paper.

use serde_json::json;

use super::robustness::columns;
use super::{ReportError, counted, csv_of, tables};
use crate::score::{Defences, Scores};

pub(super) const NAMES: [&str; 2] = ["defences.csv", "defences.tex"];

/// Names and contents of the files; none where it was not asked for.
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

/// Both tables, with what the defences are above them.
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

/// As one line of a comment.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
