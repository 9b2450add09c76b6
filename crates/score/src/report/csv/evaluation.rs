//! Tables of an evaluation for spreadsheets.

use serde_json::json;

use crate::report::csv::rows::csv_of;
use crate::report::{Evaluation, ReportError};

pub(crate) fn figures_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
    let mut rows = Vec::new();
    // 1: made against this detector; 2: transfer.
    for (table, detectors) in [(1, evaluation.targets()), (2, evaluation.others())] {
        for pattern in &evaluation.patterns {
            for detector in &detectors {
                let name = &detector.manifest.name;
                let Some(f) = evaluation.scores.summary(name, pattern).map(|s| &s.overall) else {
                    continue;
                };
                rows.push(vec![
                    ("table", json!(table)),
                    ("pattern", json!(pattern)),
                    ("detector", json!(name)),
                    ("photos", json!(f.photos)),
                    ("ap_definition", json!(evaluation.scores.criteria.ap.name())),
                    ("box_labels", json!(detector.box_labels())),
                    ("ap50", json!(f.ap50)),
                    ("mean_confidence", json!(f.mean_confidence)),
                    ("hits", json!(f.hit_rate.count)),
                    ("hit_rate", json!(f.hit_rate.rate)),
                ]);
            }
        }
    }
    csv_of(rows)
}

pub(crate) fn differences_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
    let results = evaluation
        .comparisons
        .iter()
        .flat_map(|c| c.results.iter().map(move |r| (&c.base, r)));
    csv_of(results.flat_map(|(base, r)| {
        let figures = [
            ("ap50", &r.ap50),
            ("mean_confidence", &r.mean_confidence),
            ("hit_rate", &r.hit_rate.rate),
        ];
        figures.map(|(figure, d)| {
            vec![
                ("base", json!(base)),
                ("pattern", json!(r.variant)),
                ("detector", json!(r.detector)),
                ("figure", json!(figure)),
                ("pairs", json!(r.pairs)),
                ("of_base", json!(d.base)),
                ("of_pattern", json!(d.other)),
                // Base minus pattern.
                ("difference", json!(d.drop)),
                ("low_95", json!(d.interval_95.map(|i| i.low))),
                ("high_95", json!(d.interval_95.map(|i| i.high))),
                ("effect", json!(r.finding.map(|finding| finding.effect))),
            ]
        })
    }))
}
