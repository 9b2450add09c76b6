//! The files of an evaluation: page, tables for a paper, and what a spreadsheet reads.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::evaluation::Evaluation;
use super::html::evaluation as page;
use super::{ReportError, csv_of, latex};
use crate::score::Finding;
use scaleproof_core::files;

/// Writes every file of an evaluation into a folder, or none, and returns the path of the page to open.
pub fn write_evaluation(folder: &Path, evaluation: &Evaluation) -> Result<PathBuf, ReportError> {
    let page = folder.join("evaluation.html");
    files::replace_all_atomically(&[
        (page.clone(), page::render(evaluation).into_bytes()),
        (folder.join("evaluation.csv"), figures_csv(evaluation)?.into_bytes()),
        (
            folder.join("differences.csv"),
            differences_csv(evaluation)?.into_bytes(),
        ),
        (
            folder.join("evaluation.tex"),
            latex::evaluation(evaluation).into_bytes(),
        ),
    ])?;
    Ok(page)
}

#[derive(Serialize)]
struct FiguresRow<'a> {
    /// 1: made against this detector; 2: transfer.
    table: u8,
    pattern: &'a str,
    detector: &'a str,
    photos: usize,
    ap_definition: &'static str,
    ap50: f64,
    mean_confidence: f64,
    hits: usize,
    hit_rate: f64,
}

fn figures_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
    let mut rows = Vec::new();
    for (table, detectors) in [(1, evaluation.targets()), (2, evaluation.others())] {
        for pattern in &evaluation.patterns {
            for detector in &detectors {
                let Some(f) = evaluation.figures(pattern, detector) else {
                    continue;
                };
                rows.push(FiguresRow {
                    table,
                    pattern,
                    detector: &detector.manifest.name,
                    photos: f.photos,
                    ap_definition: evaluation.scores.criteria.ap.name(),
                    ap50: f.ap50,
                    mean_confidence: f.mean_confidence,
                    hits: f.hit_rate.count,
                    hit_rate: f.hit_rate.rate,
                });
            }
        }
    }
    csv_of(rows)
}

#[derive(Serialize)]
struct DifferenceRow<'a> {
    base: &'a str,
    pattern: &'a str,
    detector: &'a str,
    figure: &'static str,
    pairs: usize,
    of_base: f64,
    of_pattern: f64,
    /// Base minus pattern.
    difference: f64,
    low_95: Option<f64>,
    high_95: Option<f64>,
    finding: Finding,
}

fn differences_csv(evaluation: &Evaluation) -> Result<String, ReportError> {
    let mut rows = Vec::new();
    for comparison in &evaluation.comparisons {
        for r in &comparison.results {
            let figures = [
                ("ap50", &r.ap50),
                ("mean_confidence", &r.mean_confidence),
                ("hit_rate", &r.hit_rate.rate),
            ];
            for (figure, d) in figures {
                rows.push(DifferenceRow {
                    base: &comparison.base,
                    pattern: &r.variant,
                    detector: &r.detector,
                    figure,
                    pairs: r.pairs,
                    of_base: d.base,
                    of_pattern: d.other,
                    difference: d.drop,
                    low_95: d.interval_95.map(|i| i.low),
                    high_95: d.interval_95.map(|i| i.high),
                    finding: d.finding,
                });
            }
        }
    }
    csv_of(rows)
}
