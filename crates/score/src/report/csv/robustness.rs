//! `robustness.csv` and `defences.csv`: differences between variants on corrupted and defended photos.

use serde_json::{Value, json};

use crate::figures::{Defences, Difference, PairedDifference, Robustness, Scores};
use crate::report::ReportError;
use crate::report::csv::rows::csv_of;
use crate::report::words::counted;

pub(crate) fn robustness(scores: &Scores, robustness: &Robustness) -> Result<String, ReportError> {
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

/// Returns `defences.csv`.
pub(crate) fn defences(scores: &Scores, defences: &Defences) -> Result<String, ReportError> {
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

/// Returns the columns of a comparison of a variant with a base.
pub(crate) fn columns(scores: &Scores, difference: &PairedDifference) -> Vec<(&'static str, Value)> {
    let mut line = vec![
        ("base", json!(difference.base)),
        ("variant", json!(difference.variant)),
        ("detector", json!(difference.detector)),
        ("pairs", json!(difference.pairs)),
    ];
    line.push(("effect", json!(difference.finding.map(|finding| finding.effect))));
    line.push(("p", json!(difference.finding.map(|finding| finding.confidence_p))));
    line.extend(CONFIDENCE.into_iter().zip(values(&difference.mean_confidence)));
    line.extend(AP50.into_iter().zip(values(&difference.ap50)));
    line.extend(HIT_RATE.into_iter().zip(values(&difference.hit_rate)));
    line.push(("ap_definition", json!(scores.criteria.ap.name())));
    line.push((
        "box_labels",
        json!(counted::box_labels_of(scores, &difference.detector)),
    ));
    line
}

/// Names of the columns of a difference, in the order of [`values`].
const AP50: [&str; 5] = ["base_ap50", "ap50", "drop_ap50", "drop_ap50_low", "drop_ap50_high"];
const HIT_RATE: [&str; 5] = [
    "base_hit_rate",
    "hit_rate",
    "drop_hit_rate",
    "drop_hit_rate_low",
    "drop_hit_rate_high",
];
const CONFIDENCE: [&str; 5] = [
    "base_mean_confidence",
    "mean_confidence",
    "drop_mean_confidence",
    "drop_mean_confidence_low",
    "drop_mean_confidence_high",
];

fn values(d: &Difference) -> [Value; 5] {
    let (low, high) = (d.interval_95.map(|i| i.low), d.interval_95.map(|i| i.high));
    [json!(d.base), json!(d.other), json!(d.drop), json!(low), json!(high)]
}
