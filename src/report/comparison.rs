//! A comparison as files, `comparison.html`, `.tex` and `.json`, and as text for the terminal.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::html::comparison as page;
use super::provenance::{self, Provenance};
use super::{ReportError, counted, figures, latex, p_value, paired};
use crate::files;
use crate::score::{Comparison, Difference, NotScored, Scores, comparison_definitions};

#[derive(Serialize)]
struct Page<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    /// The labels that count as the model.
    classes: &'a [String],
    cautions: &'a [String],
    not_scored: &'a [NotScored],
    definitions: BTreeMap<&'static str, &'static str>,
    provenance: Provenance,
}

/// Writes every file of a comparison into a folder, or none, and returns the path of the page to open.
pub(crate) fn write_comparison(
    folder: &Path,
    scores: &Scores,
    comparison: &Comparison,
) -> Result<PathBuf, ReportError> {
    let page = folder.join("comparison.html");
    let mut all = vec![
        (page.clone(), page::render(scores, comparison).into_bytes()),
        (
            folder.join("comparison.tex"),
            latex::comparison(scores, comparison).into_bytes(),
        ),
        (
            folder.join("comparison.json"),
            comparison_json(scores, comparison)?.into_bytes(),
        ),
    ];
    let figures = figures::of_comparison(scores, comparison)?;
    all.extend(figures.into_iter().map(|(name, content)| (folder.join(name), content)));
    files::replace_all_atomically(&all)?;
    Ok(page)
}

/// The whole of `comparison.json`.
pub(crate) fn comparison_json(scores: &Scores, comparison: &Comparison) -> Result<String, ReportError> {
    let page = Page {
        comparison,
        classes: counted::classes(scores).labels(),
        cautions: &scores.cautions,
        not_scored: &scores.not_scored,
        definitions: comparison_definitions().collect(),
        provenance: provenance::of(scores),
    };
    Ok(serde_json::to_string_pretty(&page)? + "\n")
}

/// Three lines per detector and variant: the drop of each figure, its interval, and the finding.
pub(crate) fn comparison_table(comparison: &Comparison) -> String {
    let mut lines = Vec::new();
    for r in &comparison.results {
        let head = format!("{}: {} → {}", r.detector, comparison.base, r.variant);
        lines.push(format!("{head}, {}", paired::basis(r)));
        let p = format!("McNemar p {}: ", p_value(r.hit_rate.mcnemar_p));
        lines.push(line("hit rate", &r.hit_rate.rate, &p));
        lines.push(line("mean confidence", &r.mean_confidence, ""));
        lines.push(line(&format!("AP@0.5 ({})", comparison.ap_definition), &r.ap50, ""));
        for bin in r.azimuth_bins.iter().filter_map(|bin| Some((bin, bin.holm_p?))) {
            let name = format!("hit rate at {}°", bin.0.azimuth_deg);
            lines.push(line(&name, &bin.0.hits.rate, &format!("Holm p {}: ", p_value(bin.1))));
        }
    }
    lines.join("\n")
}

fn line(name: &str, d: &Difference, test: &str) -> String {
    let number = |v: f64| format!("{v:.2}");
    let interval = paired::interval(d, number).unwrap_or_else(|| "no interval".to_owned());
    let (asr, finding) = (paired::asr(d, number), paired::in_words(d.finding));
    format!(
        "  {name:<24} {:.3} → {:.3}, drop {:.3} {interval}, ASR {asr}  {test}{finding}",
        d.base, d.other, d.drop
    )
}
