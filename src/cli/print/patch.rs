//! Results of `print patch`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

/// `print patch --json`.
#[derive(Serialize, JsonSchema)]
pub struct Answer {
    pub patches: Vec<PatchAnswer>,
}

#[derive(Serialize, JsonSchema)]
pub struct PatchAnswer {
    pub name: String,
    /// The side of the model.
    pub panel: &'static str,
    /// Right of the model's middle, and up from the ground.
    pub at_mm: [f64; 2],
    /// Width and height.
    pub size_mm: [f64; 2],
    /// Share of the patch beside its panel.
    pub off_panel_share: f64,
}
