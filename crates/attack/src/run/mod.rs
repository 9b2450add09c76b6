//! The attack (DTA, CVPR 2022, algorithm 1): a pattern's cells are moved against the confidence of detectors, through
//! the texture projection, the surrogate renderer and the augmentation.
//!
//! - [`view_set`]: the views, each with its surrogate renderer and texture projection;
//! - [`augmentation`]: what happens between the pattern and the detector;
//! - [`loss`], [`penalty`], [`adam`]: what is moved against what, and how;
//! - [`printer`]: what comes out of the printer for the cells;
//! - [`judge`]: how often a pattern is still detected in the views held out;
//! - [`weights`]: how much each of several detectors counts;
//! - [`difficulty`]: which views a step looks at;
//! - [`resample`]: images made larger or smaller, and moved;
//! - `together`: images looked at in parallel;
//! - [`history`], [`checkpoint`]: what is kept of a run.

pub mod adam;
pub mod augmentation;
pub mod checkpoint;
pub mod difficulty;
pub mod history;
pub mod judge;
pub mod loss;
pub mod penalty;
pub mod printer;
pub mod resample;
mod together;
pub mod view_set;
pub mod weights;

use std::borrow::Cow;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::time::Instant;

use image::RgbImage;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg32;
use serde::{Deserialize, Serialize};

use adam::CellMoments;
use augmentation::{Augmentation, Eot};
use checkpoint::Checkpoint;
use difficulty::Difficulty;
use history::Entry;
use printer::PrinterMap;
use view_set::{TextureMapping, ViewSet};
use weights::{Against, DetectorWeights};

use scaleproof_core::files::FileError;
use scaleproof_core::workers;
use scaleproof_frames::FramesError;
use scaleproof_frames::surrogate::renderer::FitError;
use scaleproof_gradients::{Boxes, WhiteBox, WhiteBoxError};
use scaleproof_pose::scene::Classes;
use scaleproof_surface::pattern::palette::Painted;
use scaleproof_surface::pattern::{Pattern, PatternError};

pub type Rgb = [f64; 3];

const JUDGED_TIMES: u32 = 12;

/// Why there is no pattern.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error("the view of {view}: {reason}")]
    Fit { view: String, reason: FitError },
    #[error(
        "{view} does not say where its paint is on the model: make the frames with attack render, or repeat the pattern over a plane that faces the camera"
    )]
    NoPositions { view: String },
    #[error("the paint is seen in none of the views: point the camera at the model")]
    NothingSeen,
    #[error("{detector} cannot look at the view of {view}: {reason}")]
    ForwardPass {
        detector: String,
        view: String,
        #[source]
        reason: Box<WhiteBoxError>,
    },
    #[error(
        "the loss of {detector} on the view of {view} is not a number (step {step}): the weights are damaged, or the frame is; nothing was moved, and \
         what was reached is kept"
    )]
    NotANumber { detector: String, view: String, step: u32 },
    #[error(
        "{path} is the checkpoint of a run with other settings, frames, detectors or classes{which}: give another folder, or remove it"
    )]
    OtherRun { path: PathBuf, which: String },
    #[error("{path} is damaged: remove it, and the run starts over")]
    Damaged { path: PathBuf },
    #[error("{path} is no history of a pattern ({reason}): make it again")]
    NotAHistory { path: PathBuf, reason: String },
    #[error("the run could not be saved ({0})")]
    Encode(String),
}

impl From<serde_json::Error> for RunError {
    fn from(e: serde_json::Error) -> Self {
        Self::Encode(e.to_string())
    }
}

impl From<postcard::Error> for RunError {
    fn from(e: postcard::Error) -> Self {
        Self::Encode(e.to_string())
    }
}

/// Cells that a pattern is kept near to, by the mean squared distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Near {
    pub weight: f64,
    /// The cells to stay near to, as many as the pattern has, sRGB of 0 to 1.
    pub cells: Vec<Rgb>,
}

/// The colours that cells have on the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CellColours {
    Free,
    /// The nearest of these, 8-bit sRGB.
    Palette(Vec<[u8; 3]>),
    /// At most so many colours, which follow the cells: their clusters.
    Own(usize),
}

/// Everything a run depends on besides the frames' and detectors' content, whose hashes are in it.
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
    /// Which boxes count.
    pub boxes: Boxes,
    /// The confidence below which the loss fades (`loss::from_floor`).
    pub floor: f64,
    /// What is made small of the losses of several detectors.
    pub against: Against,
    /// The share of a step's views that are drawn for how well the model is still seen in them.
    pub hard: f64,
    /// Seed of the first pattern, the batches and the augmentations.
    pub seed: u64,
    /// How the pattern lies on the model.
    #[serde(rename = "laying")]
    pub mapping: TextureMapping,
    /// The augmentations that expectation over transformation draws from.
    pub eot: Eot,
    /// Weight of the total variation.
    pub smooth: f64,
    /// What the pattern is kept near to.
    pub near: Option<Near>,
    /// The printer that the pattern is optimised for: cells are what is requested of it.
    pub printer: Option<PrinterMap>,
    /// What colours cells have.
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
    /// The usual attack on what counts as the model by these labels. Frames and detectors are named by
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

/// An attack under way.
pub struct Attack<'a> {
    view_set: &'a ViewSet,
    detectors: &'a [Box<dyn WhiteBox>],
    config: &'a AttackConfig,
    checkpoint: Checkpoint,
    state: AttackState,
    started: Instant,
    threads: usize,
}

/// The state of the cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackState {
    pub cells: Vec<Rgb>,
    pub adam: CellMoments,
    pub weights: DetectorWeights,
    pub difficulty: Difficulty,
}

/// What detectors make of one image.
#[derive(Debug, Clone, PartialEq)]
pub struct LossAndGradient {
    /// The loss of each detector: [`loss::from_floor`] of the most confident box that meets the model; 0 where none does.
    pub losses: Vec<f64>,
    /// `Σ C` of these boxes.
    pub confidence: f64,
    /// The gradient of the weighted sum of the losses with respect to the cells.
    pub gradient: Vec<Rgb>,
}

impl<'a> Attack<'a> {
    /// Begins, or goes on from the checkpoint in `folder`.
    ///
    /// # Errors
    /// A checkpoint that is damaged or of another run.
    pub fn begin(
        view_set: &'a ViewSet,
        detectors: &'a [Box<dyn WhiteBox>],
        config: &'a AttackConfig,
        folder: &Path,
    ) -> Result<Self, RunError> {
        let key = checkpoint::key(config)?;
        let path = folder.join(checkpoint::FILE);
        let (checkpoint, state) = match Checkpoint::load(folder, &key)? {
            Some(found) => {
                let state: Option<AttackState> = postcard::from_bytes(&found.content).ok();
                let whole = state.filter(|s| s.cells.len() == view_set.grid.cells());
                (found, whole.ok_or(RunError::Damaged { path })?)
            }
            None => {
                let first = Pattern::random_grid(config.mapping.grid(config.cells), config.seed)?;
                let [low, high] = config.range.map(|v| f64::from(v) / 255.0);
                let cells = of_pattern(&first)
                    .into_iter()
                    .map(|cell| cell.map(|v| v.clamp(low, high)));
                let cells: Vec<Rgb> = cells.collect();
                let state = AttackState {
                    adam: CellMoments::new(cells.len()),
                    weights: DetectorWeights::new(detectors.len()),
                    difficulty: Difficulty::new(view_set.views.len()),
                    cells,
                };
                (Checkpoint::new(key, Vec::new()), state)
            }
        };
        Ok(Self {
            view_set,
            detectors,
            config,
            checkpoint,
            state,
            started: Instant::now(),
            threads: workers::thread_count(),
        })
    }

    /// Sets the number of threads, else one a core; the pattern does not depend on it.
    pub fn over_threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Steps until it is done; saves at most half a minute apart, and before it gives up. `on_step` gets the steps done
    /// and the last entry.
    ///
    /// # Errors
    /// A loss that is not a number, a detector that cannot look, a folder that takes no files.
    pub fn run(
        mut self,
        folder: &Path,
        mut on_step: impl FnMut(u32, &Entry),
    ) -> Result<(Vec<Rgb>, Vec<Entry>), RunError> {
        let wall_before = self.checkpoint.history.last().map_or(0.0, |e| e.wall_s);
        let mut saved = Instant::now();
        // A run that was stopped before it judged its last step judges it now.
        if self.judge_if_due(folder)? {
            self.save(folder)?;
        }
        for step in self.checkpoint.steps..self.config.steps {
            // A step that fails has moved nothing.
            let entry = self.step(step);
            let mut entry = self.saved_if_failed(entry, folder)?;
            entry.wall_s = wall_before + self.started.elapsed().as_secs_f64();
            self.checkpoint.history.push(entry);
            self.checkpoint.steps = step + 1;
            self.judge_if_due(folder)?;
            if let Some(entry) = self.checkpoint.history.last_mut() {
                entry.wall_s = wall_before + self.started.elapsed().as_secs_f64();
                on_step(step + 1, entry);
            }
            if step + 1 == self.config.steps || saved.elapsed() > checkpoint::AT_MOST {
                self.save(folder)?;
                saved = Instant::now();
            }
        }
        Ok((finished(&self.state.cells, self.config), self.checkpoint.history))
    }

    /// Judges the pattern of the last step, where that step is one of those whose pattern is judged; whether it did. The step itself is kept
    /// when judging fails.
    fn judge_if_due(&mut self, folder: &Path) -> Result<bool, RunError> {
        let (done, steps) = (self.checkpoint.steps, self.config.steps);
        let is_due = done > 0 && (done == steps || (done - 1) % (steps / JUDGED_TIMES).max(1) == 0);
        let is_judged = |entry: &Entry| entry.held_out.is_some();
        if !is_due || self.checkpoint.history.last().is_none_or(is_judged) {
            return Ok(false);
        }
        let judged = judge::judge(self.view_set, self.detectors, &shown(&self.state.cells, self.config));
        let judgement = self.saved_if_failed(judged, folder)?;
        if let Some(entry) = self.checkpoint.history.last_mut() {
            entry.held_out = Some(judgement);
        }
        Ok(true)
    }

    /// Keeps what was reached before an error is passed on.
    fn saved_if_failed<T>(&mut self, result: Result<T, RunError>, folder: &Path) -> Result<T, RunError> {
        if result.is_err() {
            self.save(folder)?;
        }
        result
    }

    fn save(&mut self, folder: &Path) -> Result<(), RunError> {
        self.checkpoint.content = postcard::to_allocvec(&self.state)?;
        self.checkpoint.save(folder)
    }

    /// One minibatch, one step of Adam.
    fn step(&mut self, step: u32) -> Result<Entry, RunError> {
        let (config, state) = (self.config, &mut self.state);
        let mut rng = drawn_by(config.seed, step);
        let trained = self.view_set.trained();
        let batch = (config.batch, config.hard);
        let views = state.difficulty.batch(&trained, batch, config.seed, step);
        let weights = state.weights.weights(config.against);
        let count = views.len();
        let (mut losses, mut confidence) = (vec![0.0; self.detectors.len()], 0.0);
        let mut gradient = vec![[0.0; 3]; state.cells.len()];
        let draws = Augmentation::of_each(views, &config.eot, &mut rng);
        let cells = shown(&state.cells, config);
        let looked = together::on_each(self.threads, self.detectors, &draws, |detectors, (view, draw)| {
            let how = (step, config.boxes, config.floor);
            loss_and_gradient(self.view_set, detectors, (*view, &cells, draw), how, &weights)
        });
        let share = |v: f64| v / count as f64;
        for (looked, (view, _)) in looked?.into_iter().zip(&draws) {
            for (sum, loss) in losses.iter_mut().zip(&looked.losses) {
                *sum += share(*loss);
            }
            confidence += share(looked.confidence) / self.detectors.len() as f64;
            add(&mut gradient, &looked.gradient, share(1.0));
            let highest = looked.losses.iter().copied().fold(0.0, f64::max);
            state.difficulty.observe(*view, highest);
        }
        state.weights.observe(&losses);
        // Choosing a paint has no derivative: the cells are moved as if they were seen themselves (straight-through, Bengio et al. 2013).
        if let Some(printer) = &config.printer {
            gradient = printer.vjp(&state.cells, &gradient);
        }
        // What the pattern is to be besides adversarial.
        let mut penalties = vec![[0.0; 3]; state.cells.len()];
        if config.smooth > 0.0 {
            let (_, derivative) = penalty::smooth(&state.cells, config.cells as usize);
            add(&mut penalties, &derivative, config.smooth);
        }
        if let Some(near) = &config.near {
            let (_, derivative) = penalty::distance(&state.cells, &near.cells);
            add(&mut penalties, &derivative, near.weight);
        }
        add(&mut gradient, &penalties, 1.0);
        let (rate, range) = (learning_rate(config, step), config.range.map(|v| f64::from(v) / 255.0));
        state.adam.step(&mut state.cells, &gradient, rate, range);
        Ok(Entry {
            step: step + 1,
            queries: u64::from(step + 1) * count as u64,
            loss: Some(losses.iter().sum()),
            confidence: Some(confidence),
            ..Entry::default()
        })
    }
}

/// The loss of one view, and its derivative with respect to the cells.
pub fn loss_and_gradient<'a>(
    view_set: &ViewSet,
    detectors: &[impl Deref<Target = dyn WhiteBox + 'a>],
    (view, cells, draw): (usize, &[Rgb], &Augmentation),
    (step, boxes, floor): (u32, Boxes, f64),
    weights: &[f64],
) -> Result<LossAndGradient, RunError> {
    let textured = view_set.textured(view, cells, draw);
    let mut on_image: Option<Vec<Rgb>> = None;
    let (mut losses, mut confidence) = (vec![0.0; detectors.len()], 0.0);
    for ((detector, weight), loss) in detectors.iter().zip(weights).zip(&mut losses) {
        let (image, size_px) = (&textured.augmented.image, view_set.size_px(view));
        let found = detector.loss_and_gradient(image, size_px, &textured.outline, boxes);
        let Some(found) = found.map_err(|reason| view_set.not_seen(view, &**detector, reason))? else {
            continue;
        };
        let numbers = [found.loss, found.confidence];
        let mut numbers = numbers.iter().chain(found.gradient.iter().flatten());
        if !numbers.all(|v| v.is_finite()) {
            return Err(view_set.not_a_number(view, &**detector, step + 1));
        }
        let (value, derivative) = loss::from_floor(found.loss, floor);
        *loss = value;
        confidence += found.confidence;
        let on_image = on_image.get_or_insert_with(|| vec![[0.0; 3]; found.gradient.len()]);
        add(on_image, &found.gradient, weight * derivative);
    }
    let none = || vec![[0.0; 3]; cells.len()];
    let gradient = on_image.map_or_else(none, |gradient| textured.vjp(gradient, cells));
    Ok(LossAndGradient {
        losses,
        confidence,
        gradient,
    })
}

/// The cells as they are on the model: as the printer makes them, or in their colours.
fn shown<'a>(cells: &'a [Rgb], config: &AttackConfig) -> Cow<'a, [Rgb]> {
    match &config.printer {
        Some(printer) => Cow::Owned(printer.printed(cells)),
        None => in_colours(cells, config),
    }
}

fn in_colours<'a>(cells: &'a [Rgb], config: &AttackConfig) -> Cow<'a, [Rgb]> {
    match &config.colours {
        CellColours::Free => Cow::Borrowed(cells),
        CellColours::Palette(paints) => {
            let paints = srgb(paints);
            let painted = |cell: &Rgb| penalty::nearest(*cell, &paints).unwrap_or(*cell);
            Cow::Owned(cells.iter().map(painted).collect())
        }
        CellColours::Own(count) => {
            let columns = config.mapping.grid(config.cells)[0];
            let pattern = Pattern::from_cells(to_image(cells, columns)).ok();
            // Fewer where the cells have fewer, or clusters would be one colour.
            let mut counts = (2..=*count).rev();
            let painted = pattern.and_then(|p| counts.find_map(|count| Painted::by_count(&p, count).ok()));
            // Cells that no two colours part become one.
            let one = || cells.first().map_or_else(Vec::new, |first| vec![*first; cells.len()]);
            Cow::Owned(painted.map_or_else(one, |painted| srgb(&painted.rgb())))
        }
    }
}

/// The cells as they are kept: in their colours, in 8 bits.
fn finished(cells: &[Rgb], config: &AttackConfig) -> Vec<Rgb> {
    let in_8_bits = |cell: &Rgb| cell.map(|v| (255.0 * v).round() / 255.0);
    in_colours(cells, config).iter().map(in_8_bits).collect()
}

/// Views of a step: every view comes once before any comes again, in a new random order each time.
pub fn batch(views: &[usize], size: u32, seed: u64, step: u32) -> Vec<usize> {
    let size = (size as usize).min(views.len());
    let shuffled = |round: usize| {
        let mut order = views.to_vec();
        order.shuffle(&mut drawn_by(seed ^ 0x5eed, round as u32));
        order
    };
    let first = step as usize * size;
    let mut orders = std::collections::BTreeMap::new();
    let at = |i: usize| {
        let round = i / views.len();
        orders.entry(round).or_insert_with(|| shuffled(round))[i % views.len()]
    };
    (first..first + size).map(at).collect()
}

/// A generator that depends on the seed and the step alone, so that a resumed run draws as one that never stopped.
pub fn drawn_by(seed: u64, step: u32) -> Pcg32 {
    Pcg32::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(u64::from(step)))
}

fn learning_rate(config: &AttackConfig, step: u32) -> f64 {
    let along = f64::from(step) / f64::from(config.steps.max(1));
    config.learning_rate * (0.55 + 0.45 * (std::f64::consts::PI * along).cos())
}

fn add(sum: &mut [Rgb], other: &[Rgb], weight: f64) {
    for (sum, other) in sum.iter_mut().zip(other) {
        *sum = std::array::from_fn(|c| sum[c] + weight * other[c]);
    }
}

/// 8-bit colours as sRGB of 0 to 1.
pub fn srgb(colours: &[[u8; 3]]) -> Vec<Rgb> {
    colours.iter().map(|rgb| rgb.map(|v| f64::from(v) / 255.0)).collect()
}

pub fn of_pattern(pattern: &Pattern) -> Vec<Rgb> {
    of_image(pattern.cells())
}

/// Pixels as sRGB of 0 to 1, row by row.
pub fn of_image(image: &RgbImage) -> Vec<Rgb> {
    image.pixels().map(|p| p.0.map(|v| f64::from(v) / 255.0)).collect()
}

/// Cells or pixels as an image of so many columns.
pub fn to_image(cells: &[Rgb], columns: u32) -> RgbImage {
    RgbImage::from_fn(columns, cells.len() as u32 / columns, |x, y| {
        image::Rgb(cells[(y * columns + x) as usize].map(|v| (255.0 * v).round() as u8))
    })
}
