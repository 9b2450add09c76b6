//! Rivals of an attack: patterns found without looking into the detector, and patterns that come from elsewhere.
//!
//! Random and flat patterns need no search. All are judged by the same views as the attack.

pub mod camou; // CAMOU, a network that imitates renderer and detector (Zhang et al., ICLR 2019)
pub mod genetic; // ER, a genetic search over a repeated mosaic (Wu et al. 2020)
pub mod patches; // finished patches in their places (UPC, DAS)

use std::path::{Path, PathBuf};
use std::time::Instant;

use rand::Rng;
use serde::{Deserialize, Serialize};

use super::run::augmentation::{Augmentation, Eot};
use super::run::checkpoint::{self, Checkpoint};
use super::run::history::Entry;
use super::run::judge::{confidence, judge};
use super::run::view_set::{TextureMapping, ViewSet};
use super::run::{Rgb, batch};
use crate::AttackError;
use scaleproof_gradients::WhiteBox;
use scaleproof_pose::scene::Classes;

/// Settings of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchConfig {
    pub method: &'static str,
    pub cells: u32,
    pub tile_mm: f64,
    /// Query budget: the most images that detectors look at.
    pub queries: u64,
    pub seed: u64,
    #[serde(rename = "laying")]
    pub mapping: TextureMapping,
    pub eot: Eot,
    pub frames_sha256: String,
    pub detectors: Vec<String>,
    /// The labels that count as the model.
    pub classes: Classes,
}

/// Surrogate renderer and detectors as one black box, which returns the score of a pattern in a view.
///
/// Scores are kept: a search that was interrupted makes the same queries again and gets them at once, so it needs no checkpoint of its own.
pub struct BlackBox<'a> {
    pub view_set: &'a ViewSet,
    detectors: &'a [Box<dyn WhiteBox>],
    config: &'a SearchConfig,
    folder: PathBuf,
    checkpoint: Checkpoint,
    known: KnownScores,
    queries: usize,
    notes: usize,
    wall_before: f64,
    started: Instant,
    saved: Instant,
    on_query: &'a dyn Fn(u64),
}

impl<'a> BlackBox<'a> {
    /// Begins a search, or goes on with the scores known in `folder`.
    pub fn begin(
        view_set: &'a ViewSet,
        detectors: &'a [Box<dyn WhiteBox>],
        config: &'a SearchConfig,
        folder: &Path,
        on_query: &'a dyn Fn(u64),
    ) -> Result<Self, AttackError> {
        let key = checkpoint::key(config)?;
        let checkpoint = Checkpoint::load(folder, &key)?.unwrap_or_else(|| Checkpoint::new(key, Vec::new()));
        let known = match checkpoint.content.as_slice() {
            [] => KnownScores::default(),
            content => postcard::from_bytes(content).map_err(|_| AttackError::Damaged {
                path: folder.join(checkpoint::FILE),
            })?,
        };
        Ok(Self {
            view_set,
            detectors,
            config,
            folder: folder.to_owned(),
            wall_before: known.wall_s,
            checkpoint,
            known,
            queries: 0,
            notes: 0,
            started: Instant::now(),
            saved: Instant::now(),
            on_query,
        })
    }

    /// Draws the trained views that a round looks at, each with a draw of the augmentations.
    fn draws(&self, views: u32, round: u32, rng: &mut impl Rng) -> Vec<(usize, Augmentation)> {
        let views = batch(&self.view_set.trained(), views, self.config.seed, round);
        Augmentation::of_each(views, &self.config.eot, rng)
    }

    /// Returns the mean over detectors of the highest confidence of a box that meets the model; `None` when the query budget is exhausted.
    pub fn score(&mut self, view: usize, cells: &[Rgb], draw: &Augmentation) -> Result<Option<f64>, AttackError> {
        if self.queries as u64 >= self.config.queries {
            return Ok(None);
        }
        if self.queries == self.known.all.len() {
            let textured = self.view_set.textured(view, cells, draw);
            let mut sum = 0.0;
            for detector in self.detectors {
                let (image, outline) = (&textured.augmented.image, &textured.outline);
                let score = confidence(self.view_set, detector.as_ref(), view, image, outline);
                if score.is_err() {
                    self.save()?;
                }
                sum += score?;
            }
            self.known.all.push(sum / self.detectors.len().max(1) as f64);
            if self.saved.elapsed() > checkpoint::AT_MOST {
                self.save()?;
            }
        }
        self.queries += 1;
        (self.on_query)(self.queries as u64);
        Ok(self.known.all.get(self.queries - 1).copied())
    }

    /// Returns the mean score of a pattern over some views, each with a draw of its own; `None` when the query budget is exhausted.
    pub fn mean_score(&mut self, views: &[(usize, Augmentation)], cells: &[Rgb]) -> Result<Option<f64>, AttackError> {
        let mut sum = 0.0;
        for (view, draw) in views {
            match self.score(*view, cells, draw)? {
                Some(score) => sum += score,
                None => return Ok(None),
            }
        }
        Ok(Some(sum / views.len().max(1) as f64))
    }

    /// Judges the best pattern so far and adds it to the history; `score` is its score in the search.
    pub fn note(&mut self, cells: &[Rgb], score: Option<f64>) -> Result<(), AttackError> {
        self.notes += 1;
        if self.notes <= self.checkpoint.history.len() {
            return Ok(());
        }
        let held_out = Some(judge(self.view_set, self.detectors, cells)?);
        self.checkpoint.history.push(Entry {
            step: self.notes as u32,
            queries: self.queries as u64,
            wall_s: self.wall_s(),
            confidence: score,
            held_out,
            ..Entry::default()
        });
        Ok(())
    }

    /// Saves and returns the history.
    pub fn finish(mut self) -> Result<Vec<Entry>, AttackError> {
        self.save()?;
        Ok(self.checkpoint.history)
    }

    /// Returns the wall time, that of earlier runs included.
    fn wall_s(&self) -> f64 {
        self.wall_before + self.started.elapsed().as_secs_f64()
    }

    fn save(&mut self) -> Result<(), AttackError> {
        self.known.wall_s = self.wall_s();
        self.checkpoint.content = postcard::to_allocvec(&self.known)?;
        self.checkpoint.save(&self.folder)?;
        self.saved = Instant::now();
        Ok(())
    }
}

/// All scores so far, in order, and the wall time that they took.
#[derive(Default, Serialize, Deserialize)]
struct KnownScores {
    all: Vec<f64>,
    wall_s: f64,
}
