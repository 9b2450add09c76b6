//! `summary.json`: figures, definitions and provenance for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use super::counted;
use super::provenance::{self, Provenance};
use crate::detect::Speeds;
use crate::score::{NotScored, Reliability, Scores, Summary, TransferRow, reliability, transfer};

#[derive(Serialize)]
struct Page<'a> {
    photos_scored: usize,
    /// The labels that count as the model.
    classes: &'a [String],
    /// How the figures called `ap50` are computed.
    ap_definition: &'static str,
    hit_confidence: f64,
    results: &'a [Summary],
    transfer: Vec<TransferRow>,
    reliability: Vec<Reliability>,
    /// Times of the detectors, where a file of them was given.
    speed: Option<&'a Speeds>,
    cautions: &'a [String],
    not_scored: &'a [NotScored],
    definitions: BTreeMap<&'static str, String>,
    provenance: Provenance,
}

pub(super) fn render(scores: &Scores, speeds: Option<&Speeds>) -> serde_json::Result<String> {
    let page = Page {
        photos_scored: scores.photos.len(),
        classes: counted::classes(scores).labels(),
        ap_definition: scores.criteria.ap.name(),
        hit_confidence: scores.criteria.hit_confidence,
        results: &scores.summaries,
        transfer: transfer(&scores.summaries),
        reliability: reliability(&scores.photos, &scores.detectors),
        speed: speeds,
        cautions: &scores.cautions,
        not_scored: &scores.not_scored,
        definitions: scores.criteria.definitions().into_iter().collect(),
        provenance: provenance::of(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}
