//! `comparison.csv`: a line for each detector, texture and endpoint: both figures, the drop and its interval, and how its finding was decided.

use serde_json::json;

use super::{ReportError, Row, counted, csv_of};
use crate::score::{Compared, Comparison, Difference, Scores};

pub fn render(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    csv_of(comparison.results.iter().flat_map(|r| {
        let endpoints = [
            ("hit_rate", &r.hit_rate.rate),
            ("mean_confidence", &r.mean_confidence),
            ("ap50", &r.ap50),
        ];
        endpoints.map(|(name, d)| row(scores, comparison, r, (name, d)))
    }))
}

fn row<'a>(scores: &Scores, comparison: &Comparison, r: &Compared, (endpoint, d): (&str, &Difference)) -> Row<'a> {
    let is_primary = endpoint == "hit_rate";
    let (drop, asr) = (d.interval_95, d.asr_interval_95);
    vec![
        ("detector", json!(r.detector)),
        ("base", json!(comparison.base)),
        ("variant", json!(r.variant)),
        ("endpoint", json!(endpoint)),
        ("role", json!(if is_primary { "primary" } else { "secondary" })),
        ("pairs", json!(r.pairs)),
        ("places", json!(r.places)),
        ("bins", json!(r.bins)),
        ("clusters", json!(r.clusters)),
        ("clustered_by", json!(r.clustered_by)),
        ("near_copies", json!(r.near_copies)),
        ("base_value", json!(d.base)),
        ("value", json!(d.other)),
        ("drop", json!(d.drop)),
        ("drop_low", json!(drop.map(|i| i.low))),
        ("drop_high", json!(drop.map(|i| i.high))),
        ("asr", json!(d.asr)),
        ("asr_low", json!(asr.map(|i| i.low))),
        ("asr_high", json!(asr.map(|i| i.high))),
        ("mcnemar_p", json!(is_primary.then_some(r.hit_rate.mcnemar_p))),
        ("holm_p", json!(is_primary.then_some(r.holm_p))),
        ("tests", json!(r.tests)),
        ("finding", json!(d.finding)),
        ("ap_definition", json!(comparison.ap_definition)),
        ("box_labels", json!(counted::box_labels_of(scores, &r.detector))),
    ]
}
