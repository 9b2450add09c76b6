//! A comparison as files, `comparison.html`, `.tex`, `.csv` and `.json`, and as text for the terminal.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::html::comparison as page;
use super::provenance::{self, Provenance};
use super::{ReportError, certainty, comparison_csv, counted, figures, latex, p_value, paired, sequential, verdict};
use crate::score::{Compared, Comparison, Difference, NotScored, Scores, comparison_definitions};
use scaleproof_core::files;
use scaleproof_core::spelling::digits;

/// `comparison.json`.
#[derive(Serialize, schemars::JsonSchema)]
pub struct ComparisonPage<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// The labels that count as the model.
    classes: &'a [String],
    /// Which labels of a box count in its figures, by detector: `best`, its best alone; `all`, each with its own confidence; `listed`, as the network
    /// lists its boxes; `given`, as another program gives them.
    box_labels: BTreeMap<&'a str, &'static str>,
    /// What weakens the figures, as sentences (explained in codes.md).
    cautions: &'a [String],
    /// Photos that are in no figure, and why.
    not_scored: &'a [NotScored],
    /// The definition of every figure, by its name.
    definitions: BTreeMap<&'static str, &'static str>,
    /// Where the figures come from: enough to repeat them, or to see why a repetition differs.
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
    files::replace_all_atomically(&all)?;
    Ok(folder.join("comparison.html"))
}

/// The whole of `comparison.json`.
pub fn comparison_json(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    let page = ComparisonPage {
        comparison,
        classes: counted::classes(scores).labels(),
        box_labels: counted::box_labels(scores),
        cautions: &scores.cautions,
        not_scored: &scores.not_scored,
        definitions: comparison_definitions().collect(),
        provenance: provenance::from_scores(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}

/// In what it differs from its plan; what was found, in a sentence; the protocol that is followed; three lines per detector and variant: the drop of each figure, its interval, and the finding; how many were tested.
pub fn comparison_table(scores: &Scores, comparison: &Comparison) -> String {
    let mut lines = Vec::new();
    if let Some(plan) = &comparison.plan {
        lines.push(format!("plan {}: {}", plan.seal, paired::deviations(plan)));
        lines.extend(plan.deviations.iter().map(|deviation| format!("  {deviation}")));
    }
    lines.extend(verdict::sentences(scores, &comparison.results));
    lines.push(String::new());
    if let Some(protocol) = scores.criteria.protocol {
        lines.push(format!("protocol {}: {}", protocol.name(), protocol.source()));
    }
    for r in &comparison.results {
        let head = format!("{}: {} → {}", r.detector, comparison.base, r.variant);
        lines.push(format!("{head}, {}", paired::basis(r)));
        let [p, corrected] = [r.hit_rate.mcnemar_p, r.holm_p].map(p_value);
        let p = format!("McNemar p {p}, corrected {corrected}: ");
        lines.push(line("hit rate", r, &r.hit_rate.rate, &p));
        lines.push(line("mean confidence", r, &r.mean_confidence, ""));
        lines.push(line(&format!("AP@0.5 ({})", comparison.ap_definition), r, &r.ap50, ""));
        for (bin, p) in r.azimuth_bins.iter().filter_map(|bin| Some((bin, bin.holm_p?))) {
            let (name, d) = (format!("hit rate at {}°", bin.azimuth_deg), &bin.hits.rate);
            // The photos of a bin have clusters of their own.
            lines.push(with_asr(
                &name,
                d,
                &paired::asr(d, two),
                &format!("Holm p {}: ", p_value(p)),
            ));
        }
    }
    lines.extend(certainty::tested(scores, &comparison.results));
    if let Some(own) = &comparison.sequential {
        lines.extend(sequential::lines(own, &comparison.base));
    }
    lines.join("\n")
}

fn line(name: &str, r: &Compared, d: &Difference, test: &str) -> String {
    with_asr(name, d, &certainty::asr_text(r, d, two), test)
}

fn with_asr(name: &str, d: &Difference, asr: &str, test: &str) -> String {
    let interval = paired::interval(d, two).unwrap_or_else(|| "no interval".to_owned());
    let [base, other, drop] = [d.base, d.other, d.drop].map(|v| digits(v, 3));
    let finding = paired::in_words(d.finding);
    format!("  {name:<24} {base} → {other}, drop {drop} {interval}, ASR {asr}  {test}{finding}")
}

fn two(value: f64) -> String {
    digits(value, 2)
}
