//! `comparison.json`: differences, definitions and provenance for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::compare::comparison_definitions;
use crate::figures::{Comparison, NotScored, Scores};
use crate::report::words::{counted, paper};
use crate::report::{Findings, Provenance, ReportError, provenance, tables};

/// `comparison.json`.
#[derive(Serialize, schemars::JsonSchema)]
pub struct ComparisonPage<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// The labels that count as the model.
    classes: &'a [String],
    /// Rule for the labels of a box that count in its figures, by detector: `best`, its best alone; `all`, each with its own confidence; `listed`, as
    /// the network lists its boxes; `given`, as another program gives them.
    box_labels: BTreeMap<&'a str, &'static str>,
    /// Cautions about the figures, as sentences (explained in codes.md).
    cautions: &'a [String],
    /// The table that the page begins with: an object for each detector and texture.
    effects: serde_json::Value,
    /// Sentences that may be written of the comparison in a paper; empty where nothing was tested.
    paper: Vec<String>,
    /// Photos that are in no figure, and why.
    not_scored: &'a [NotScored],
    /// The definition of every figure, by its name.
    definitions: BTreeMap<&'static str, &'static str>,
    /// Origin of the figures: enough to repeat them, or to see why a repetition differs.
    provenance: Provenance,
}

/// Returns the whole text of `comparison.json`.
pub fn comparison_json(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    let findings = Findings::of_comparison(scores, comparison);
    let page = ComparisonPage {
        comparison,
        classes: counted::classes(scores).labels(),
        box_labels: counted::box_labels(scores),
        cautions: &scores.cautions,
        effects: tables::effects(findings).json(),
        paper: paper::sentences(findings),
        not_scored: &scores.not_scored,
        definitions: comparison_definitions().collect(),
        provenance: provenance::from_scores(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}
