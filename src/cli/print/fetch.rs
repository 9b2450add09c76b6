//! Results of `detectors fetch`, as JSON and in words.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

/// `detectors fetch --json`: one object a line for each detector.
#[derive(Serialize, JsonSchema)]
pub struct Fetched {
    pub name: String,
    /// Where the weights now are.
    pub path: PathBuf,
}
