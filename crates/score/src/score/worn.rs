//! The patterns that the textures of a run are, as far as they are known: no figure depends on them.

use serde::Serialize;

/// The pattern of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct WornPattern {
    pub variant: String,
    /// Name of its file.
    pub file: String,
    /// Of the file.
    pub sha256: String,
    /// Columns, rows.
    pub cells: [u32; 2],
    /// Width of one repeat on the model.
    pub tile_mm: Option<f64>,
    /// ΔE2000 between pattern and print, mean over cells.
    pub print_delta_e: Option<f64>,
    /// One pixel per cell.
    #[serde(skip)]
    pub png: Vec<u8>,
}
