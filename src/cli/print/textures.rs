//! Results of `texture`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

/// `texture bake --json`; `files` are the image, the `.obj`, the `.mtl`, images of other materials, the `.glb`.
#[derive(Serialize, JsonSchema)]
pub struct Baked {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Parts of the image whose paint hangs together.
    pub charts: usize,
    /// Side of a texel on the model, where it has the mean area.
    pub texel_mm: f64,
    /// Why the mesh's own texture coordinates are not kept.
    pub unwrapped: Option<String>,
}

/// `texture show --json`.
#[derive(Serialize, JsonSchema)]
pub struct Shown {
    /// Of the views, in their order.
    pub azimuth_deg: Vec<f64>,
    /// Of all of them.
    pub pitch_deg: f64,
    /// From the camera to the middle of the box around the model, at which all look.
    pub distance_mm: f64,
    /// Horizontal.
    pub field_of_view_deg: f64,
}
