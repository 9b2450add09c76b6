//! The settings of an attack.

use serde::Serialize;

use super::augmentation::Eot;
use super::cells::Rgb;
use super::printer::PrinterMap;
use super::view_set::TextureMapping;
use super::weights::Against;
use scaleproof_gradients::Boxes;
use scaleproof_pose::scene::Classes;

/// Penalty on the mean squared distance to other cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Near {
    pub weight: f64,
    /// The cells to stay near to, as many as the pattern has, sRGB of 0 to 1.
    pub cells: Vec<Rgb>,
}

/// Colours of cells on the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CellColours {
    Free,
    /// The nearest of these, 8-bit sRGB.
    Palette(Vec<[u8; 3]>),
    /// Colours of clusters of the cells, at most this number.
    Own(usize),
}

/// Settings of an attack: all that a run depends on, frames and detectors by their hashes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AttackConfig {
    /// Cells along each side of the pattern.
    pub cells: u32,
    /// Width of one repeat of the pattern on the model, mm.
    pub tile_mm: f64,
    /// Steps of the optimiser.
    pub steps: u32,
    /// Views a step.
    pub batch: u32,
    /// The learning rate in sRGB of 0 to 1; it falls to a tenth along half a cosine.
    #[serde(rename = "rate")]
    pub learning_rate: f64,
    /// Boxes that count in the loss.
    pub boxes: Boxes,
    /// The confidence below which the loss fades (`loss::from_floor`).
    pub floor: f64,
    /// Objective of several detectors' losses.
    pub against: Against,
    /// Share of a step's views that are drawn for how well the model is still seen in them.
    pub hard: f64,
    /// Seed of the first pattern, the batches and the augmentations.
    pub seed: u64,
    /// Mapping of the pattern onto the model.
    #[serde(rename = "laying")]
    pub mapping: TextureMapping,
    /// The augmentations that expectation over transformation draws from.
    pub eot: Eot,
    /// Weight of the total variation.
    pub smooth: f64,
    /// Cells that the pattern is kept near to.
    pub near: Option<Near>,
    /// Printer that the pattern is optimised for: cells are the requested colours.
    pub printer: Option<PrinterMap>,
    /// Colours of cells.
    pub colours: CellColours,
    /// Darkest and lightest value of a cell, 8-bit sRGB.
    pub range: [u8; 2],
    /// SHA-256 of the list of frames.
    pub frames_sha256: String,
    /// Names and hashes of weights.
    pub detectors: Vec<String>,
    /// The labels that count as the model.
    pub classes: Classes,
}

impl AttackConfig {
    /// Returns the default attack on the model as these labels count it. Frames and detectors are named by
    /// [`Setup::named`](crate::setup::Setup::named).
    pub fn usual(classes: Classes) -> Self {
        Self {
            cells: 24,
            tile_mm: 118.0,
            steps: 300,
            batch: 8,
            learning_rate: 0.1,
            boxes: Boxes::default(),
            floor: 0.0003,
            against: Against::default(),
            hard: 0.5,
            seed: 1,
            mapping: TextureMapping::default(),
            eot: Eot::USUAL,
            smooth: 0.0,
            near: None,
            printer: None,
            colours: CellColours::Free,
            range: [0, 255],
            frames_sha256: String::new(),
            detectors: Vec::new(),
            classes,
        }
    }
}
