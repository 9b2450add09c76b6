//! Labels that count as the model, in words for every place where figures stand.

use std::collections::BTreeMap;

use crate::evaluated::EvaluatedDetector;
use crate::figures::{ScoredPhoto, Scores};
use scaleproof_plot::distinct;
use scaleproof_pose::scene::Classes;

/// Returns the labels that count as the model, those of the first session; all sessions of a run have the same.
pub(crate) fn classes(scores: &Scores) -> &Classes {
    &scores.sessions[0].scene.model.class
}

/// Returns [`labels`] with each detector's rule for the labels of a box: "car; labels of a box: best (yolox_nano), all (nanodet_m)".
pub fn counted(scores: &Scores) -> String {
    let rules = box_labels(scores);
    let of_rule = |rule: &str| {
        let own = rules.iter().filter(|(_, own)| **own == rule).map(|(name, _)| *name);
        format!("{rule} ({})", own.collect::<Vec<_>>().join(", "))
    };
    let rule = match distinct(rules.values().copied())[..] {
        [only] => only.to_owned(),
        ref several => several.iter().map(|rule| of_rule(rule)).collect::<Vec<_>>().join(", "),
    };
    format!("{}; labels of a box: {rule}", labels(scores))
}

/// Definitions of the rules for the labels of a box.
pub(crate) const BOX_LABELS: &str = "each detector's own rule. best: a box counts with its best label alone; all: with every label, each with its own confidence; listed: as the network lists its boxes; given: as another program gives them";

/// Returns each detector's rule for the labels of a box, by the detector's name.
pub fn box_labels(scores: &Scores) -> BTreeMap<&str, &'static str> {
    let each = scores.detectors.iter();
    each.map(|detector| (detector.manifest.name.as_str(), detector.box_labels()))
        .collect()
}

/// Returns the rule for the labels of a box of the detector called `name`.
pub(crate) fn box_labels_of(scores: &Scores, name: &str) -> Option<&'static str> {
    let own = scores.detectors.iter().find(|detector| detector.manifest.name == name);
    own.map(EvaluatedDetector::box_labels)
}

/// Returns the labels that count as the model, "car or truck", with those that detectors map: "car or truck (mine: PKW as car)".
pub(crate) fn labels(scores: &Scores) -> String {
    let mapped: Vec<String> = scores.detectors.iter().filter_map(mapped).collect();
    if mapped.is_empty() {
        classes(scores).to_string()
    } else {
        format!("{} ({})", classes(scores), mapped.join("; "))
    }
}

/// Returns the labels that a detector counts under another name than their own: "mine: PKW as car".
fn mapped(detector: &EvaluatedDetector) -> Option<String> {
    let manifest = &detector.manifest;
    let renamed = detector.counted.iter().filter_map(|label| {
        let (own, counted) = (manifest.labels.name(*label)?, manifest.counts_as(*label)?);
        (own != counted).then(|| format!("{own} as {counted}"))
    });
    let renamed: Vec<String> = renamed.collect();
    (!renamed.is_empty()).then(|| format!("{}: {}", manifest.name, renamed.join(", ")))
}

pub(crate) fn labels_of(detector: &EvaluatedDetector) -> Vec<&'static str> {
    let names = detector.counted.iter().map(|label| detector.labels().name(*label));
    names.flatten().collect()
}

/// Returns the name of another label on the model, with its confidence.
pub(crate) fn other_label(
    photo: &ScoredPhoto,
    index: usize,
    detector: &EvaluatedDetector,
) -> Option<(&'static str, f64)> {
    let (label, confidence) = photo.outcomes[index].other?;
    Some((detector.labels().name(label).unwrap_or("?"), confidence))
}
