//! `summary.json`: figures, definitions and provenance for programs.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::Value;

use crate::figures::{
    Compared, Curves, Defences, NotScored, ProtocolTable, Ranking, Reliability, Robustness, Scores, Summary,
    TransferRow, curves, disagreements, protocol_table, reliability, transfer,
};
use crate::report::words::{counted, paper};
use crate::report::{Provenance, RunReport, provenance};
use scaleproof_detect::Speeds;

/// `summary.json`.
#[derive(Serialize, schemars::JsonSchema)]
pub struct SummaryPage<'a> {
    photos_scored: usize,
    /// The labels that count as the model.
    classes: &'a [String],
    /// Definition of the figures called `ap50`: `coco-101`, `all-point`, `voc-11` or `yolov5-ramp` (figures.md).
    ap_definition: &'static str,
    /// Rule for the labels of a box that count in its figures, by detector: `best`, its best alone; `all`, each with its own confidence; `listed`, as
    /// the network lists its boxes; `given`, as another program gives them.
    box_labels: BTreeMap<&'a str, &'static str>,
    /// Confidence from which a detection counts as a hit, 0 to 1.
    hit_confidence: f64,
    /// The variant that drops are measured from.
    base: &'a str,
    /// The second plain round of `--control`, which holds back what it moves by as much; `null` where none is named.
    control: Option<&'a str>,
    /// The protocol that is followed, with its source and table; `null` for none.
    protocol: Option<ProtocolTable>,
    /// One for each detector and variant, the base first.
    results: &'a [Summary],
    /// Each variant against the base on paired photos, as `results` of `comparison.json`.
    paired: &'a [Compared],
    /// Sentences on where AP and hit rate disagree, and why.
    explanations: Vec<String>,
    /// With `--corrupt`: what is left of the differences on photos made worse (scoring.md); else `null`.
    robustness: Option<&'a Robustness>,
    /// With `--defence`: what is left of the differences on defended photos, and what each defence changes (scoring.md); else `null`.
    defences: Option<&'a Defences>,
    /// With `--ranking`: the order of the variants against that in other sessions; else `null`.
    ranking: Option<&'a Ranking>,
    /// One row for each variant but the base.
    transfer: Vec<TransferRow>,
    /// One for each detector and variant.
    curves: Vec<Curves>,
    /// One for each detector.
    reliability: Vec<Reliability>,
    /// Times of the detectors, from the file of `--speed`; `null` without one.
    speed: Option<&'a Speeds>,
    /// Cautions about the figures, as sentences (explained in codes.md).
    cautions: &'a [String],
    /// The table that the report begins with: an object for each detector and texture but the base.
    effects: Value,
    /// Sentences that may be written of the comparison in a paper; empty where nothing was tested.
    paper: Vec<String>,
    /// Photos that are in no figure, and why.
    not_scored: &'a [NotScored],
    /// The definition of every figure, by its name.
    definitions: BTreeMap<&'static str, String>,
    /// Origin of the figures: enough to repeat them, or to see why a repetition differs.
    provenance: Provenance,
}

/// Returns the whole text of `summary.json`.
///
/// # Errors
/// Fails on figures that JSON cannot represent.
pub fn summary_json(scores: &Scores, speeds: Option<&Speeds>) -> serde_json::Result<String> {
    summary(&RunReport::new(scores, speeds))
}

pub(crate) fn summary(report: &RunReport) -> serde_json::Result<String> {
    let RunReport { scores, findings, .. } = *report;
    let page = SummaryPage {
        photos_scored: scores.photos.len(),
        classes: counted::classes(scores).labels(),
        ap_definition: scores.criteria.ap.name(),
        box_labels: counted::box_labels(scores),
        hit_confidence: scores.criteria.hit_confidence,
        base: &scores.base,
        control: scores.control.as_deref(),
        protocol: protocol_table(scores),
        results: &scores.summaries,
        paired: findings.results,
        explanations: disagreements(scores),
        robustness: scores.robustness.as_ref(),
        defences: scores.defences.as_ref(),
        ranking: scores.ranking.as_ref(),
        transfer: transfer(&scores.summaries),
        curves: curves(scores),
        reliability: reliability(&scores.photos, &scores.detectors),
        speed: report.speeds,
        cautions: &scores.cautions,
        effects: report.tables.effects.json(),
        paper: paper::sentences(findings),
        not_scored: &scores.not_scored,
        definitions: scores.criteria.definitions().into_iter().collect(),
        provenance: provenance::from_scores(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}
