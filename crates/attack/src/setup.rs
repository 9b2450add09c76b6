//! The frames, views and detectors that a pattern is made on and judged by.

use super::run::AttackConfig;
use super::run::augmentation::Eot;
use super::run::history::{Entry, History};
use super::run::view_set::{TextureMapping, ViewSet};
use crate::AttackError;
use scaleproof_core::files;
use scaleproof_frames::FrameSet;
use scaleproof_frames::surrogate::projection::Grid;
use scaleproof_gradients::WhiteBox;
use scaleproof_pose::scene::Classes;

pub struct Setup {
    pub frames: Vec<FrameSet>,
    pub frames_sha256: String,
    /// Width of one repeat of the pattern on the model.
    pub tile_mm: f64,
    pub view_set: ViewSet,
    pub detectors: Vec<Box<dyn WhiteBox>>,
    pub detector_names: Vec<String>,
    pub classes: Classes,
}

impl Setup {
    /// Opens the views of some frames for a square pattern of so many columns, and for what an augmentation draws. `on_view` is called after each, from any thread.
    pub fn open(
        frames: Vec<FrameSet>,
        (columns, tile_mm, mapping): (u32, f64, TextureMapping),
        eot: &Eot,
        (detectors, detector_names, classes): (Vec<Box<dyn WhiteBox>>, Vec<String>, Classes),
        on_view: impl Fn() + Sync,
    ) -> Result<Self, AttackError> {
        let grid = Grid::new(mapping.grid(columns), tile_mm);
        Ok(Self {
            tile_mm,
            view_set: ViewSet::open(&frames, grid, mapping, eot, on_view)?,
            frames_sha256: sha256(&frames),
            frames,
            detectors,
            detector_names,
            classes,
        })
    }

    /// Settings of an attack on this: with the names of its frames and detectors.
    pub fn named(&self, config: AttackConfig) -> AttackConfig {
        AttackConfig {
            frames_sha256: self.frames_sha256.clone(),
            detectors: self.detector_names.clone(),
            ..config
        }
    }

    pub fn history(&self, method: &str, seed: u64, entries: Vec<Entry>) -> History {
        History {
            scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
            method: method.to_owned(),
            seed,
            tile_mm: self.tile_mm,
            frames_sha256: self.frames_sha256.clone(),
            detectors: self.detector_names.clone(),
            classes: Some(self.classes.clone()),
            entries,
        }
    }
}

/// SHA-256 of the frames' lists: that of the only one, or that of all in their order.
fn sha256(frames: &[FrameSet]) -> String {
    match frames {
        [only] => only.sha256.clone(),
        several => {
            let hashes: String = several.iter().map(|set| set.sha256.as_str()).collect();
            files::sha256_hex(hashes.as_bytes())
        }
    }
}
