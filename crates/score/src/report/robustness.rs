//! What is left of the differences when photos get worse, as a table for the terminal and for spreadsheets.

use serde_json::{Value, json};

use super::{ReportError, counted, csv_of, protocol};
use crate::score::{BASE_LOST, Difference, Held, Robustness, SEVERITIES, Scores, Survival};
use scaleproof_plot::distinct;

pub(super) const NAME: &str = "robustness.csv";

pub(super) fn heading() -> String {
    format!(
        "severities at which the 95 % interval of the drop of AP@0.5 lies above 0, uncorrected (0: reduced to 640 px, no worse; ?: too few photos for an interval; \
         lost: the base itself has an AP below {BASE_LOST} there)"
    )
}

pub(super) fn csv(scores: &Scores, robustness: &Robustness) -> Result<String, ReportError> {
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
        line.extend(columns(scores, &row.held));
        line
    }))
}

/// Of a comparison.
pub(super) fn columns(scores: &Scores, held: &Held) -> Vec<(&'static str, Value)> {
    let mut line = vec![
        ("base", json!(held.base)),
        ("variant", json!(held.variant)),
        ("detector", json!(held.detector)),
        ("pairs", json!(held.pairs)),
    ];
    line.push(("effect", json!(held.finding.map(|finding| finding.effect))));
    line.push(("p", json!(held.finding.map(|finding| finding.confidence_p))));
    line.extend(CONFIDENCE.into_iter().zip(values(&held.mean_confidence)));
    line.extend(AP50.into_iter().zip(values(&held.ap50)));
    line.extend(HIT_RATE.into_iter().zip(values(&held.hit_rate)));
    line.push(("ap_definition", json!(scores.criteria.ap.name())));
    line.push(("box_labels", json!(counted::box_labels_of(scores, &held.detector))));
    line
}

/// Columns of a difference, as [`values`] has them.
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

/// A head, then a line for each detector and comparison with a column for each corruption.
pub(super) fn survival_table(robustness: &Robustness) -> Vec<Vec<String>> {
    let corruptions = robustness.corruptions();
    let head = ["detector", "texture", "from"]
        .into_iter()
        .chain(corruptions.iter().copied());
    let mut rows = vec![head.map(str::to_owned).collect::<Vec<_>>()];
    let key = |s: &Survival| [s.detector.clone(), s.variant.clone(), s.base.clone()];
    for names in distinct(robustness.survival.iter().map(key)) {
        let own = |corruption: &&str| {
            let mut all = robustness.survival.iter();
            all.find(|s| s.corruption == *corruption && key(s) == names)
        };
        let cells = corruptions
            .iter()
            .map(|corruption| own(corruption).map_or_else(String::new, cell));
        let cells: Vec<String> = cells.collect();
        rows.push([names.to_vec(), cells].concat());
    }
    rows
}

/// As in `0–2, lost 4–5`.
fn cell(survival: &Survival) -> String {
    let shown = match (&survival.above_zero_at[..], survival.without_interval_at.len()) {
        ([], too_few) if too_few > usize::from(SEVERITIES) => "?".to_owned(),
        ([], _) => "none".to_owned(),
        (shown, _) => ranges(shown),
    };
    match &survival.base_lost_at[..] {
        [] => shown,
        lost => format!("{shown}, lost {}", ranges(lost)),
    }
}

/// Ascending numbers, as in `0–2, 4`.
fn ranges(numbers: &[u8]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let text = runs.map(|run| match run {
        [only] => only.to_string(),
        run => format!("{}–{}", run[0], run[run.len() - 1]),
    });
    text.collect::<Vec<_>>().join(", ")
}

/// For the terminal; nothing where it was not asked for.
pub(super) fn lines(scores: &Scores) -> Vec<String> {
    let Some(robustness) = &scores.robustness else {
        return Vec::new();
    };
    let rows = survival_table(robustness);
    let aligned = protocol::aligned(&rows.iter().collect::<Vec<_>>());
    [String::new(), format!("on photos made worse: {}", heading())]
        .into_iter()
        .chain(aligned)
        .collect()
}
