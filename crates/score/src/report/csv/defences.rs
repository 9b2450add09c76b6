//! `defences.csv`: differences between variants on defended photos.

use serde_json::json;

use crate::figures::{Defences, Scores};
use crate::report::ReportError;
use crate::report::csv::paired_columns::columns;
use crate::report::csv::rows::csv_of;

/// Returns `defences.csv`.
pub(crate) fn csv(scores: &Scores, defences: &Defences) -> Result<String, ReportError> {
    let rows = [("drop", &defences.rows), ("change", &defences.changes)];
    let rows = rows
        .into_iter()
        .flat_map(|(what, rows)| rows.iter().map(move |row| (what, row)));
    csv_of(rows.map(|(what, row)| {
        let mut line = vec![("of", json!(what)), ("defence", json!(row.defence))];
        line.extend(columns(scores, &row.difference));
        line
    }))
}
