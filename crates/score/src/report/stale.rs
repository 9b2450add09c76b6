//! Files of an earlier report that the present one does not write.

use std::path::Path;

use serde::Deserialize;

use crate::report::{ReportError, RunReport, charts};
use scaleproof_core::files;
use scaleproof_detect::Manifest;

pub(crate) const SUMMARY: &str = "summary.json";
pub(crate) const DEFENCES: [&str; 2] = ["defences.csv", "defences.tex"];
pub(crate) const PROTOCOL: [&str; 2] = ["protocol.csv", "protocol.tex"];
pub(crate) const ROBUSTNESS: &str = "robustness.csv";

/// Contents of an earlier report in the folder that this one may not have.
#[derive(Deserialize, Default)]
pub(crate) struct EarlierReport {
    results: Vec<EarlierResults>,
    #[serde(default)]
    protocol: Option<serde::de::IgnoredAny>,
    #[serde(default)]
    robustness: Option<serde::de::IgnoredAny>,
    #[serde(default)]
    defences: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
struct EarlierResults {
    detector: String,
}

impl EarlierReport {
    pub(crate) fn in_folder(folder: &Path) -> EarlierReport {
        let summary = folder.join(SUMMARY);
        files::inputs::own(&summary);
        let text = files::read_text(&summary).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }
}

/// Removes files that an earlier run left and this one does not write: COCO results of other detectors, whose ids mean other photos now, and the
/// tables and charts of a protocol, of times, of corruptions and of defences that this run does not have.
pub(crate) fn remove_stale(folder: &Path, before: &EarlierReport, report: &RunReport) -> Result<(), ReportError> {
    let scores = report.scores;
    let no_longer_robustness = before.robustness.is_some() && scores.robustness.is_none();
    let mut stale = charts::files::stale(report, no_longer_robustness);
    if no_longer_robustness {
        stale.push(ROBUSTNESS.to_owned());
    }
    if before.defences.is_some() && scores.defences.is_none() {
        stale.extend(DEFENCES.map(str::to_owned));
    }
    if before.protocol.is_some() && scores.criteria.protocol.is_none() {
        stale.extend(PROTOCOL.map(str::to_owned));
    }
    let built_in = Manifest::all()
        .unwrap_or_default()
        .into_iter()
        .map(|manifest| manifest.name);
    // The summary may be somebody else's: only valid names of detectors become part of a path.
    let names = before.results.iter().map(|result| result.detector.clone());
    let names = built_in.chain(names.filter(|name| Manifest::is_name(name)));
    let others = names.filter(|name| scores.detectors.iter().all(|c| c.manifest.name != *name));
    stale.extend(others.map(|name| results_name(&name)));
    Ok(stale
        .iter()
        .try_for_each(|name| files::chosen::remove(folder, &folder.join(name)))?)
}

pub(crate) fn results_name(detector: &str) -> String {
    format!("coco_results_{detector}.json")
}
