//! Files of an evaluation: its page, tables for a paper, and CSV for spreadsheets.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::report::evaluation::Evaluation;
use crate::report::html::evaluation as page;
use crate::report::{ReportError, csv_of, latex};
use scaleproof_core::files;

/// Writes every file of an evaluation into a folder, or none, and returns the path of the page to open.
pub fn write_evaluation(folder: &Path, evaluation: &Evaluation) -> Result<PathBuf, ReportError> {
    let texts = [
        ("evaluation.html", page::render(evaluation)),
        ("evaluation.csv", figures_csv(evaluation)?),
        ("differences.csv", differences_csv(evaluation)?),
        ("evaluation.tex", latex::evaluation(evaluation)),
    ];
    files::replace_all_atomically(
        folder,
        &texts.map(|(name, text)| (folder.join(name), text.into_bytes())),
    )?;
    Ok(folder.join("evaluation.html"))
}

fn figures_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
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

fn differences_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
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
