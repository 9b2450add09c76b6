//! Patterns of the textures of a run, as far as they are known: no figure depends on them.

use serde::Serialize;

/// The pattern of a texture.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TexturePattern {
    /// The texture that has the pattern.
    pub variant: String,
    /// Name of the pattern's file.
    pub file: String,
    /// SHA-256 of the pattern's file.
    pub sha256: String,
    /// Columns and rows.
    pub cells: [u32; 2],
    /// Width of one repeat on the model; `null` when it is not known.
    pub tile_mm: Option<f64>,
    /// ΔE2000 between pattern and print, mean over cells; `null` without `--printer`.
    pub print_delta_e: Option<f64>,
    /// One pixel per cell.
    #[serde(skip)]
    pub png: Vec<u8>,
}
