//! `summary.json`: figures, definitions and provenance for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use super::counted;
use super::provenance::{self, Provenance};
use crate::score::{
    Compared, Curves, NotScored, ProtocolTable, Ranking, Reliability, Robustness, Scores, Summary, TransferRow, curves,
    disagreements, paired, protocol_table, reliability, transfer,
};
use scaleproof_detect::Speeds;

/// `summary.json`.
#[derive(Serialize, schemars::JsonSchema)]
pub struct SummaryPage<'a> {
    photos_scored: usize,
    /// The labels that count as the model.
    classes: &'a [String],
    /// How the figures called `ap50` are computed.
    ap_definition: &'static str,
    hit_confidence: f64,
    /// The variant that drops are measured from.
    base: &'a str,
    /// The protocol that is followed, with its source and table.
    protocol: Option<ProtocolTable>,
    results: &'a [Summary],
    /// Each variant against the base on paired photos, as in `comparison.json`.
    paired: &'a [Compared],
    /// Where AP and hit rate disagree, and why.
    explanations: Vec<String>,
    /// What is left of the differences when photos get worse, where it was asked for.
    robustness: Option<&'a Robustness>,
    /// The order of the variants against that in other sessions, where it was asked for.
    ranking: Option<&'a Ranking>,
    transfer: Vec<TransferRow>,
    curves: Vec<Curves>,
    reliability: Vec<Reliability>,
    /// Times of the detectors, where a file of them was given.
    speed: Option<&'a Speeds>,
    cautions: &'a [String],
    not_scored: &'a [NotScored],
    definitions: BTreeMap<&'static str, String>,
    provenance: Provenance,
}

pub(super) fn render(scores: &Scores, speeds: Option<&Speeds>) -> serde_json::Result<String> {
    let page = SummaryPage {
        photos_scored: scores.photos.len(),
        classes: counted::classes(scores).labels(),
        ap_definition: scores.criteria.ap.name(),
        hit_confidence: scores.criteria.hit_confidence,
        base: &scores.base,
        protocol: protocol_table(scores),
        results: &scores.summaries,
        paired: paired(scores),
        explanations: disagreements(scores),
        robustness: scores.robustness.as_ref(),
        ranking: scores.ranking.as_ref(),
        transfer: transfer(&scores.summaries),
        curves: curves(scores),
        reliability: reliability(&scores.photos, &scores.detectors),
        speed: speeds,
        cautions: &scores.cautions,
        not_scored: &scores.not_scored,
        definitions: scores.criteria.definitions().into_iter().collect(),
        provenance: provenance::from_scores(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}
