//! `comparison.csv`: a line for each detector, texture and endpoint, with both figures, the drop and its interval, and the effect of the texture on
//! the detector.

use serde_json::json;

use crate::figures::{Compared, Comparison, Control, Difference, Scores};
use crate::report::ReportError;
use crate::report::csv::rows::{Row, csv_of};
use crate::report::words::counted;

pub fn render(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    let control = comparison.control.iter().flat_map(|control| &control.results);
    csv_of(comparison.results.iter().chain(control).flat_map(|r| {
        let endpoints = [
            ("mean_confidence", &r.mean_confidence),
            ("hit_rate", &r.hit_rate.rate),
            ("ap50", &r.ap50),
        ];
        endpoints.map(|(name, d)| row(scores, comparison, r, name, d))
    }))
}

fn row<'a>(scores: &Scores, comparison: &Comparison, r: &Compared, endpoint: &str, d: &Difference) -> Row<'a> {
    let (drop, asr) = (d.interval_95, d.asr_interval_95);
    let is_control = |control: &Control| control.variant == r.variant;
    let (role, p, level) = match (endpoint, r.finding) {
        _ if comparison.control.as_ref().is_some_and(is_control) => ("control", None, None),
        ("mean_confidence", finding) => (
            "primary",
            finding.map(|f| f.confidence_p),
            finding.map(|f| f.confidence_level),
        ),
        ("hit_rate", finding) => (
            "second",
            finding.map(|f| f.hit_rate_p),
            finding.map(|f| f.hit_rate_level),
        ),
        _ => ("interval alone", None, None),
    };
    vec![
        ("detector", json!(r.detector)),
        ("base", json!(comparison.base)),
        ("variant", json!(r.variant)),
        ("endpoint", json!(endpoint)),
        ("role", json!(role)),
        ("pairs", json!(r.pairs)),
        ("places", json!(r.places)),
        ("bins", json!(r.bins)),
        ("clusters", json!(r.clusters)),
        ("near_copies", json!(r.near_copies)),
        ("base_value", json!(d.base)),
        ("value", json!(d.other)),
        ("drop", json!(d.drop)),
        ("drop_low", json!(drop.map(|i| i.low))),
        ("drop_high", json!(drop.map(|i| i.high))),
        ("asr", json!(d.asr)),
        ("asr_low", json!(asr.map(|i| i.low))),
        ("asr_high", json!(asr.map(|i| i.high))),
        ("p", json!(p)),
        ("level", json!(level)),
        ("effect", json!(r.finding.map(|f| f.effect))),
        (
            "withheld_by_control",
            json!(r.finding.and_then(|f| f.withheld_by_control)),
        ),
        (
            "effect_in_places_like_these",
            json!(r.finding.and_then(|f| f.in_places_like_these).map(|like| like.effect)),
        ),
        ("ap_definition", json!(comparison.ap_definition)),
        ("box_labels", json!(counted::box_labels_of(scores, &r.detector))),
    ]
}
