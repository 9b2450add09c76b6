//! `robustness.csv`: differences between variants on corrupted photos.

use serde_json::json;

use crate::figures::{Robustness, Scores};
use crate::report::ReportError;
use crate::report::csv::paired_columns::columns;
use crate::report::csv::rows::csv_of;

pub(crate) fn csv(scores: &Scores, robustness: &Robustness) -> Result<String, ReportError> {
    let rows = [("drop", &robustness.rows), ("change", &robustness.changes)];
    let rows = rows
        .into_iter()
        .flat_map(|(what, rows)| rows.iter().map(move |row| (what, row)));
    csv_of(rows.map(|(what, row)| {
        let mut line = vec![
            ("of", json!(what)),
            ("corruption", json!(row.corruption)),
            ("severity", json!(row.severity)),
            ("amount", json!(row.amount)),
        ];
        line.extend(columns(scores, &row.difference));
        line
    }))
}
