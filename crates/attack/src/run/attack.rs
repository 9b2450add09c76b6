//! The attack: its steps.

use std::borrow::Cow;
use std::ops::Deref;
use std::path::Path;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::adam::CellMoments;
use super::augmentation::Augmentation;
use super::cells::{Rgb, of_pattern, srgb, to_image};
use super::checkpoint::{self, Checkpoint};
use super::config::{AttackConfig, CellColours};
use super::difficulty::Difficulty;
use super::draw::drawn_by;
use super::history::Entry;
use super::view_set::ViewSet;
use super::weights::DetectorWeights;
use super::{judge, loss, parallel, penalty};
use crate::AttackError;
use scaleproof_core::workers;
use scaleproof_gradients::{Boxes, WhiteBox};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::palette::Painted;

/// Number of judgements in a run, about.
const JUDGED_TIMES: u32 = 12;

/// Attack under way.
pub struct Attack<'a> {
    view_set: &'a ViewSet,
    detectors: &'a [Box<dyn WhiteBox>],
    config: &'a AttackConfig,
    checkpoint: Checkpoint,
    state: AttackState,
    started: Instant,
    threads: usize,
}

/// State of an attack between two steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackState {
    pub cells: Vec<Rgb>,
    pub adam: CellMoments,
    pub weights: DetectorWeights,
    pub difficulty: Difficulty,
}

/// Losses of one image, and their gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct LossAndGradient {
    /// Loss of each detector: [`loss::from_floor`] of the most confident box that meets the model; 0 where none does.
    pub losses: Vec<f64>,
    /// `Σ C` of these boxes.
    pub confidence: f64,
    /// The gradient of the weighted sum of the losses with respect to the cells.
    pub gradient: Vec<Rgb>,
}

impl<'a> Attack<'a> {
    /// Begins an attack, or goes on from the checkpoint in `folder`.
    pub fn begin(
        view_set: &'a ViewSet,
        detectors: &'a [Box<dyn WhiteBox>],
        config: &'a AttackConfig,
        folder: &Path,
    ) -> Result<Self, AttackError> {
        let key = checkpoint::key(config)?;
        let path = folder.join(checkpoint::FILE);
        let (checkpoint, state) = match Checkpoint::load(folder, &key)? {
            Some(found) => {
                let state: Option<AttackState> = postcard::from_bytes(&found.content).ok();
                let whole = state.filter(|s| s.cells.len() == view_set.grid.cells());
                (found, whole.ok_or(AttackError::Damaged { path })?)
            }
            None => {
                let first = Pattern::random_grid(config.mapping.grid(config.cells), config.seed)?;
                let [low, high] = config.range.map(|v| f64::from(v) / 255.0);
                let mut cells = of_pattern(&first);
                cells.iter_mut().flatten().for_each(|v| *v = v.clamp(low, high));
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

    /// Sets the number of threads, by default one a core; the pattern does not depend on it.
    pub fn over_threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Takes all steps; saves at least every half minute, and before it fails. Returns the pattern's cells and the history. `on_step` is called with
    /// the steps done and the last entry.
    pub fn run(
        mut self,
        folder: &Path,
        mut on_step: impl FnMut(u32, &Entry),
    ) -> Result<(Vec<Rgb>, Vec<Entry>), AttackError> {
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

    /// Judges the pattern of the last step, where that step is one of those whose pattern is judged, and returns true if it did. The step itself is
    /// kept when judging fails.
    fn judge_if_due(&mut self, folder: &Path) -> Result<bool, AttackError> {
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

    /// Saves before an error is passed on.
    fn saved_if_failed<T>(&mut self, result: Result<T, AttackError>, folder: &Path) -> Result<T, AttackError> {
        if result.is_err() {
            self.save(folder)?;
        }
        result
    }

    fn save(&mut self, folder: &Path) -> Result<(), AttackError> {
        self.checkpoint.content = postcard::to_allocvec(&self.state)?;
        self.checkpoint.save(folder)
    }

    /// Takes one step of Adam on one minibatch.
    fn step(&mut self, step: u32) -> Result<Entry, AttackError> {
        let (config, state) = (self.config, &mut self.state);
        let mut rng = drawn_by(config.seed, step);
        let trained = self.view_set.trained();
        let views = (state.difficulty).batch(&trained, config.batch, config.hard, config.seed, step);
        let weights = state.weights.weights(config.against);
        let count = views.len();
        let (mut losses, mut confidence) = (vec![0.0; self.detectors.len()], 0.0);
        let mut gradient = vec![[0.0; 3]; state.cells.len()];
        let draws = Augmentation::of_each(views, &config.eot, &mut rng);
        let cells = shown(&state.cells, config);
        let results = parallel::evaluate_each(self.threads, self.detectors, &draws, |detectors, (view, draw)| {
            let how = (step, config.boxes, config.floor);
            loss_and_gradient(self.view_set, detectors, (*view, &cells, draw), how, &weights)
        });
        let share = |v: f64| v / count as f64;
        for (found, (view, _)) in results?.into_iter().zip(&draws) {
            for (sum, loss) in losses.iter_mut().zip(&found.losses) {
                *sum += share(*loss);
            }
            confidence += share(found.confidence) / self.detectors.len() as f64;
            add(&mut gradient, &found.gradient, share(1.0));
            let highest = found.losses.iter().copied().fold(0.0, f64::max);
            state.difficulty.observe(*view, highest);
        }
        state.weights.observe(&losses);
        // Choosing a paint has no derivative: the cells are moved as if they were seen themselves (straight-through, Bengio et al. 2013).
        if let Some(printer) = &config.printer {
            gradient = printer.vjp(&state.cells, &gradient);
        }
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

/// Computes the losses of one view, and their gradient with respect to the cells.
pub fn loss_and_gradient<'a>(
    view_set: &ViewSet,
    detectors: &[impl Deref<Target = dyn WhiteBox + 'a>],
    (view, cells, draw): (usize, &[Rgb], &Augmentation),
    (step, boxes, floor): (u32, Boxes, f64),
    weights: &[f64],
) -> Result<LossAndGradient, AttackError> {
    let textured = view_set.textured(view, cells, draw);
    let mut on_image: Option<Vec<Rgb>> = None;
    let (mut losses, mut confidence) = (vec![0.0; detectors.len()], 0.0);
    for ((detector, weight), loss) in detectors.iter().zip(weights).zip(&mut losses) {
        let (image, size_px) = (&textured.augmented.image, view_set.size_px(view));
        let found = detector.loss_and_gradient(image, size_px, &textured.outline, boxes);
        let Some(found) = found.map_err(|reason| view_set.forward_pass_failed(view, &**detector, reason))? else {
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

/// Returns the cells as they are on the model: printed, or in their colours.
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

/// Returns the cells of the result: in their colours, in 8 bits.
fn finished(cells: &[Rgb], config: &AttackConfig) -> Vec<Rgb> {
    let in_8_bits = |cell: &Rgb| cell.map(|v| (255.0 * v).round() / 255.0);
    in_colours(cells, config).iter().map(in_8_bits).collect()
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
