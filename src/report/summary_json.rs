//! `summary.json`: figures, definitions and provenance for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use super::provenance::{self, Provenance};
use crate::score::{DEFINITIONS, NotScored, Scores, Summary};

#[derive(Serialize)]
struct Page<'a> {
    photos_scored: usize,
    results: &'a [Summary],
    cautions: &'a [String],
    not_scored: &'a [NotScored],
    definitions: BTreeMap<&'static str, &'static str>,
    provenance: Provenance,
}

pub(super) fn render(scores: &Scores) -> serde_json::Result<String> {
    let page = Page {
        photos_scored: scores.photos.len(),
        results: &scores.summaries,
        cautions: &scores.cautions,
        not_scored: &scores.not_scored,
        definitions: DEFINITIONS.into_iter().collect(),
        provenance: provenance::of(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}
