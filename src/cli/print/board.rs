//! Results of `print board`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

/// `print board --json`.
#[derive(Serialize, JsonSchema)]
pub struct Answer {
    /// The board in a line.
    pub board: String,
    /// The path of its file.
    pub definition: String,
}
