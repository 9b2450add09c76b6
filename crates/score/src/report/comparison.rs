//! A comparison as files, `comparison.html`, `.tex`, `.csv` and `.json`, and as text for the terminal.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::compare::comparison_definitions;
use crate::figures::{Compared, Comparison, Difference, NotScored, Scores};
use crate::report::html::comparison as page;
use crate::report::provenance::Provenance;
use crate::report::{
    ReportError, certainty, comparison_csv, counted, figures, latex, paired, paper, provenance, screen, tables, verdict,
};
use scaleproof_core::files;
use scaleproof_core::spelling::digits;

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

/// Writes every file of a comparison into a folder, or none, and returns the path of the page to open.
pub fn write_comparison(folder: &Path, scores: &Scores, comparison: &Comparison) -> Result<PathBuf, ReportError> {
    let texts = [
        ("comparison.html", page::render(scores, comparison)),
        ("comparison.tex", latex::comparison(scores, comparison)),
        ("comparison.csv", comparison_csv::render(scores, comparison)?),
        ("comparison.json", comparison_json(scores, comparison)?),
    ];
    let mut all = texts
        .map(|(name, text)| (folder.join(name), text.into_bytes()))
        .to_vec();
    let figures = figures::of_comparison(scores, comparison)?;
    all.extend(figures.into_iter().map(|(name, content)| (folder.join(name), content)));
    files::replace_all_atomically(folder, &all)?;
    Ok(folder.join("comparison.html"))
}

/// Returns the whole text of `comparison.json`.
pub fn comparison_json(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    let page = ComparisonPage {
        comparison,
        classes: counted::classes(scores).labels(),
        box_labels: counted::box_labels(scores),
        cautions: &scores.cautions,
        effects: tables::effects(scores, &comparison.results, &comparison.base).json(),
        paper: paper::sentences(
            scores,
            &comparison.results,
            &comparison.base,
            paper::Judged::of(comparison),
        ),
        not_scored: &scores.not_scored,
        definitions: comparison_definitions().collect(),
        provenance: provenance::from_scores(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}

/// Returns a comparison for the terminal: deviations from its plan; a sentence on the findings for each texture, and what they rest on; a line for
/// each detector and texture; the looks of a sequential test.
pub fn comparison_table(scores: &Scores, comparison: &Comparison) -> String {
    let (results, base) = (&comparison.results, &comparison.base);
    let mut lines = Vec::new();
    if let Some(plan) = &comparison.plan {
        lines.push(format!("plan {}: {}", plan.seal, paired::deviations(plan)));
        lines.extend(plan.deviations.iter().map(|deviation| format!("  {deviation}")));
    }
    lines.extend(verdict::sentences(scores, results, base));
    lines.extend(verdict::basis(scores, results));
    lines.push(String::new());
    lines.extend(screen::on_screen(&tables::effects(scores, results, base)));
    if let Some(own) = &comparison.sequential {
        lines.push(String::new());
        lines.extend(tables::looks(scores, own).described());
    }
    lines.join("\n")
}

/// Returns the parts of a comparison that the screen leaves out: sentences for a paper, the drop of each figure with its interval, how effects were
/// decided, and the labels that count as the model.
pub fn further_comparison(scores: &Scores, comparison: &Comparison) -> String {
    let mut lines = paper::sentences(
        scores,
        &comparison.results,
        &comparison.base,
        paper::Judged::of(comparison),
    );
    lines.push(String::new());
    let control = comparison.control.iter().flat_map(|control| &control.results);
    for r in comparison.results.iter().chain(control) {
        let head = format!("{}: {} → {}", r.detector, comparison.base, r.variant);
        let words = match &comparison.control {
            Some(control) if control.variant == r.variant => "the control".to_owned(),
            _ => paired::in_words(r, &comparison.base),
        };
        lines.push(format!("{head}, {}: {words}", paired::basis(r)));
        lines.push(line("mean confidence", r, &r.mean_confidence));
        lines.push(line("hit rate", r, &r.hit_rate.rate));
        lines.push(line(&format!("AP@0.5 ({})", comparison.ap_definition), r, &r.ap50));
    }
    lines.extend(certainty::tested(scores, &comparison.results).filter(|_| comparison.sequential.is_none()));
    if let Some(protocol) = scores.criteria.protocol {
        lines.push(format!("protocol {}: {}", protocol.name(), protocol.source()));
    }
    lines.push(format!("counts as the model: {}", counted::counted(scores)));
    lines.join("\n")
}

fn line(name: &str, r: &Compared, d: &Difference) -> String {
    let interval = paired::interval(d, two).unwrap_or_else(|| "no interval".to_owned());
    let [base, other, drop] = [d.base, d.other, d.drop].map(|v| digits(v, 3));
    let asr = certainty::asr_text(r, d, two);
    format!("  {name:<24} {base} → {other}, drop {drop} {interval}, ASR {asr}")
}

fn two(value: f64) -> String {
    digits(value, 2)
}
