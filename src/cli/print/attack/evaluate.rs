//! Results of `attack evaluate`, as JSON and in words.

use std::collections::BTreeMap;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_pose::scene::Classes;
use scaleproof_score::Comparison;
use scaleproof_score::Summary;

/// `attack evaluate --json`.
#[derive(Serialize, JsonSchema)]
pub struct Evaluated<'a> {
    /// The labels that count as the model.
    pub classes: &'a Classes,
    /// As in `summary.json`.
    pub box_labels: BTreeMap<&'a str, &'static str>,
    /// Names of the patterns.
    pub patterns: &'a [String],
    /// The detectors that the patterns were made against.
    pub targets: &'a [String],
    /// As in `summary.json`.
    pub results: &'a [Summary],
    /// As in `comparison.json`.
    pub comparisons: &'a [Comparison],
    /// The path of the page.
    pub page: &'a Path,
}
