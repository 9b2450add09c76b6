//! What counts as the model: said wherever figures stand.

use crate::score::{EvaluatedDetector, Scores};
use scaleproof_pose::scene::Classes;

/// The labels that count, of the first session; all sessions of a run have the same.
pub(super) fn classes(scores: &Scores) -> &Classes {
    &scores.sessions[0].scene.model.class
}

/// "car or truck", and of detectors that map labels of their own: "car or truck (mine: PKW as car)".
pub fn counted(scores: &Scores) -> String {
    let mapped: Vec<String> = scores.detectors.iter().filter_map(mapped).collect();
    if mapped.is_empty() {
        classes(scores).to_string()
    } else {
        format!("{} ({})", classes(scores), mapped.join("; "))
    }
}

/// The labels that a detector counts by another name than their own.
fn mapped(detector: &EvaluatedDetector) -> Option<String> {
    let manifest = &detector.manifest;
    let renamed = detector.counted.iter().filter_map(|label| {
        let (own, counted) = (manifest.labels.name(*label)?, manifest.counts_as(*label)?);
        (own != counted).then(|| format!("{own} as {counted}"))
    });
    let renamed: Vec<String> = renamed.collect();
    (!renamed.is_empty()).then(|| format!("{}: {}", manifest.name, renamed.join(", ")))
}

pub(super) fn labels_of(detector: &EvaluatedDetector) -> Vec<&'static str> {
    let names = detector.counted.iter().map(|label| detector.labels().name(*label));
    names.flatten().collect()
}
