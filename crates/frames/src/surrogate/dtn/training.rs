//! Training: Adam on the binary cross-entropy over the paint (CVPR 2022, algorithm 2).
//!
//! A batch is eight views in four colours each: TF does not depend on the colour, so that one pass of the network serves four images. Views are
//! mirrored, moved within the window, and put under brighter, darker, tinted and mixed light, which is exact in linear light: frames come from a
//! few lights, and the network is asked about others. What is kept as the network is the running mean of the weights, which is smoother than the
//! weights of any one step.
//!
//! Every step draws its random numbers from the seed and its own number, so that training that was interrupted goes on as if it had not been.

use std::path::Path;

use rand::seq::SliceRandom;
use rand::{Rng, RngExt};
use rand_pcg::Pcg32;
use serde::{Deserialize, Serialize};

use super::data::{CropPlacement, NewLight, PaintWindow, TrainingSet, TrainingView};
use super::network::LayerShapes;
use super::trained::DtnNetwork;
use super::{Architecture, Transformer};
use crate::{FramesError, light};
use scaleproof_core::message::{Hint, bail};
use scaleproof_gradients::adam::Adam;

const ADAM: Adam = Adam {
    learning_rate: 1e-3,
    epsilon: 1e-7,
};
const BATCH_VIEWS: usize = 8;
const COLOURS_A_VIEW: usize = 4;
/// Decay of the running mean of weights, after the first steps.
const MEAN_KEEPS: f64 = 0.998;
/// Steps between two validations.
pub const VALIDATE_EVERY: u64 = 100;
/// Distance from 0 and 1 nearer than which the derivative of the cross-entropy, infinite there, stays the same.
const EDGE: f64 = 0.01;

/// Settings that must be the same for training to go on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrainingPlan {
    pub architecture: Architecture,
    /// Each view of a batch takes its reference image in one of them at random.
    pub references: Vec<[u8; 3]>,
    pub seed: u64,
    /// SHA-256 of the training data.
    pub data_sha256: String,
}

/// A measurement during training.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct TrainingProgress {
    /// Training steps so far.
    pub step: u64,
    /// Training time so far, s.
    pub seconds: f64,
    /// Mean binary cross-entropy over the steps since the last measurement.
    pub loss: f64,
    /// Mean squared error on the validation views in unseen colours, in sRGB of 0 to 1; `null` without such views.
    pub validation_mse: Option<f64>,
}

/// State of a training, as it is saved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trainer {
    plan: TrainingPlan,
    pub steps: u64,
    pub seconds: f64,
    pub history: Vec<TrainingProgress>,
    /// Sum and number of the losses since the last entry of the history.
    losses: (f64, u64),
    /// Kernel and bias of each convolution in turn.
    pub weights: Vec<Vec<f32>>,
    mean: Vec<Vec<f32>>,
    /// Adam's two moments of each list of weights; none before the first step.
    moments: Vec<(Vec<f32>, Vec<f32>)>,
}

struct Sample<'a> {
    view: &'a TrainingView,
    placement: CropPlacement,
    reference: Vec<[f32; 3]>,
    /// Colours and the paint's pixels in them, sRGB 0 to 1.
    targets: Vec<([u8; 3], Vec<[f32; 3]>)>,
}

impl TrainingPlan {
    /// Lists the settings in which this plan differs from another.
    fn differences(&self, other: &Self) -> String {
        let colours: Vec<String> = self.references.iter().map(|rgb| light::to_hex(*rgb)).collect();
        let references = format!("the reference {}", colours.join(" "));
        let sha256 = &self.data_sha256;
        let frames = format!("the frames {}", sha256.get(..8).unwrap_or(sha256));
        let words = [
            (self.architecture != other.architecture, self.architecture.name()),
            (self.references != other.references, references),
            (self.seed != other.seed, format!("seed {}", self.seed)),
            (self.data_sha256 != other.data_sha256, frames),
        ];
        let differing = words.into_iter().filter(|(differs, _)| *differs);
        Vec::from_iter(differing.map(|(_, words)| words)).join(", ")
    }
}

impl Trainer {
    /// Begins a training, or resumes the known one of the file `path`.
    pub fn begin(plan: TrainingPlan, known: Option<Self>, path: &Path) -> Result<Self, FramesError> {
        match known {
            None => Ok(Self::new(plan)),
            Some(known) if known.plan == plan => Ok(known),
            Some(known) => bail!(
                "{} was trained with {}, and not with {}: give the same again, or another file",
                path.display(),
                known.plan.differences(&plan),
                plan.differences(&known.plan)
            ),
        }
    }

    /// Begins a training.
    pub fn new(plan: TrainingPlan) -> Self {
        let first = LayerShapes::new(plan.architecture).first_weights(plan.seed, &plan.references);
        Self {
            plan,
            steps: 0,
            seconds: 0.0,
            history: Vec::new(),
            losses: (0.0, 0),
            mean: first.clone(),
            weights: first,
            moments: Vec::new(),
        }
    }

    /// Returns true when the weights are those of its architecture.
    pub(super) fn is_whole(&self) -> bool {
        if !self.plan.architecture.is_possible() || self.plan.references.is_empty() {
            return false;
        }
        let layout = LayerShapes::new(self.plan.architecture);
        let first = self.moments.iter().map(|(first, _)| first);
        let second = self.moments.iter().map(|(_, second)| second);
        let fits = layout.fits(&self.weights) && layout.fits(&self.mean);
        fits && (self.moments.is_empty() || layout.fits(first) && layout.fits(second))
    }

    /// Fails when a weight is not finite any more.
    pub(super) fn check_numbers(&self) -> Result<(), FramesError> {
        let moments = self.moments.iter().flat_map(|(first, second)| [first, second]);
        let mut numbers = self.weights.iter().chain(&self.mean).chain(moments).flatten();
        self.check_finite(numbers.all(|v| v.is_finite()))
    }

    fn check_finite(&self, is_finite: bool) -> Result<(), FramesError> {
        let (step, hint) = (self.steps, Hint::new("the seed is ‹seed›"));
        if is_finite {
            Ok(())
        } else {
            Err(FramesError::NotFinite { step, hint })
        }
    }

    /// Counts the steps that see every training view once.
    pub fn steps_an_epoch(set: &TrainingSet) -> u64 {
        set.training.len().div_ceil(BATCH_VIEWS) as u64
    }

    /// Takes one step; returns its loss.
    pub fn step(&mut self, set: &TrainingSet) -> Result<f64, FramesError> {
        let (window, batch) = self.batch(set);
        let image = |sample: &Sample| {
            let mut image = vec![0.0; 3 * window.pixels()];
            window.fill(&mut image, &sample.view.paint, sample.placement, &sample.reference);
            image
        };
        let share = 1.0 / batch.len() as f64;
        let loss =
            |sample: &Sample, maps: &[f32]| loss(self.plan.architecture.transformer, sample, share, window, maps);
        let network = LayerShapes::new(self.plan.architecture).network(&self.weights, window.size());
        let (loss, gradients) = network.loss_and_derivatives(&batch, image, loss);
        self.check_finite(loss.is_finite())?;
        self.move_weights(&gradients);
        self.losses = (self.losses.0 + loss, self.losses.1 + 1);
        Ok(loss)
    }

    /// Takes one step of Adam, and of the mean.
    fn move_weights(&mut self, gradients: &[Vec<f32>]) {
        if self.moments.is_empty() {
            let zeros = |list: &Vec<f32>| (vec![0.0; list.len()], vec![0.0; list.len()]);
            self.moments = self.weights.iter().map(zeros).collect();
        }
        let keeps = MEAN_KEEPS.min((1.0 + self.steps as f64) / (10.0 + self.steps as f64));
        let [keeps, takes] = [keeps, 1.0 - keeps].map(|share| share as f32);
        self.steps += 1;
        let step = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let lists = self.weights.iter_mut().zip(&mut self.mean).zip(&mut self.moments);
        for (((weights, mean), (first, second)), gradient) in lists.zip(gradients) {
            ADAM.step(step, weights, gradient, [first, second]);
            for (mean, weight) in mean.iter_mut().zip(weights) {
                *mean = *mean * keeps + *weight * takes;
            }
        }
    }

    /// Draws the views of this step: those of an epoch in random order, every one once, in batches of like size, so that a window is no larger than
    /// its views need.
    fn batch<'a>(&self, set: &'a TrainingSet) -> (PaintWindow, Vec<Sample<'a>>) {
        let steps = Self::steps_an_epoch(set);
        let (epoch, number) = (self.steps / steps, self.steps % steps);
        let mut rng = Pcg32::new(self.plan.seed, 2 * epoch);
        let mut order: Vec<&TrainingView> = set.training.iter().collect();
        order.shuffle(&mut rng);
        order.sort_by_key(|view| PaintWindow::around(&[&view.paint]).pixels());
        let mut batches: Vec<&[&TrainingView]> = order.chunks(BATCH_VIEWS).collect();
        batches.shuffle(&mut rng);
        let batch = batches.get(number as usize).copied().unwrap_or_default();
        let paints: Vec<_> = batch.iter().map(|v| &v.paint).collect();
        let window = PaintWindow::around(&paints);
        let mut rng = Pcg32::new(self.plan.seed, 2 * self.steps + 1);
        let samples = batch.iter().filter_map(|view| self.sample(set, view, window, &mut rng));
        (window, samples.collect())
    }

    fn sample<'a>(
        &self,
        set: &TrainingSet,
        view: &'a TrainingView,
        window: PaintWindow,
        rng: &mut impl Rng,
    ) -> Option<Sample<'a>> {
        let placement = window.anywhere(&view.paint, rng);
        let light = NewLight::random(set, view, rng);
        let reference = self.plan.references[rng.random_range(0..self.plan.references.len())];
        let colours: Vec<[u8; 3]> = (0..COLOURS_A_VIEW).map(|_| view.colour(set, rng)).collect();
        let target = |rgb: [u8; 3]| Some((rgb, view.image(rgb, &light)?));
        Some(Sample {
            view,
            placement,
            reference: view.image(reference, &light)?,
            targets: colours.into_iter().map(target).collect::<Option<_>>()?,
        })
    }

    /// Measures the network as it stands and adds to the history.
    pub fn validate(&mut self, set: &TrainingSet) -> TrainingProgress {
        let (sum, count) = std::mem::take(&mut self.losses);
        let progress = TrainingProgress {
            step: self.steps,
            seconds: self.seconds,
            loss: sum / count.max(1) as f64,
            validation_mse: self.validation_mse(set),
        };
        self.history.push(progress);
        progress
    }

    fn validation_mse(&self, set: &TrainingSet) -> Option<f64> {
        let network = self.network();
        let transformer = self.plan.architecture.transformer;
        let (mut sum, mut count) = (0.0, 0);
        for view in &set.validation {
            let Some(reference) = view.image(self.plan.references[0], &NewLight::NONE) else {
                continue;
            };
            let maps = network.maps(&view.paint, &reference);
            for rgb in view.validation_colours(set) {
                let Some(truth) = view.image(rgb, &NewLight::NONE) else {
                    continue;
                };
                let mut error = 0.0;
                for (of_pixel, truth) in maps.chunks_exact(transformer.channels()).zip(&truth) {
                    for channel in 0..3 {
                        let maps = transformer.maps(channel, |i| f64::from(of_pixel[i]));
                        let x = transformer.value(maps, f64::from(rgb[channel]) / 255.0).clamp(0.0, 1.0);
                        error += (x - f64::from(truth[channel])).powi(2);
                    }
                }
                sum += error / (3 * truth.len()) as f64;
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Returns the network as it stands: the running mean of its weights.
    pub fn network(&self) -> DtnNetwork {
        DtnNetwork {
            architecture: self.plan.architecture,
            references: self.plan.references.clone(),
            training_seconds: self.seconds,
            weights: self.mean.clone(),
        }
    }
}

/// Returns the mean cross-entropy over an image's targets, each the mean over its paint's pixels and channels, by its share in the batch; and its
/// gradient with respect to TF. NaN where a number of TF is none: cut between 0 and 1, it would not show.
fn loss(transformer: Transformer, sample: &Sample, share: f64, window: PaintWindow, maps: &[f32]) -> (f64, Vec<f32>) {
    let pixels = window.pixels();
    let mut map_gradients = vec![0.0; maps.len()];
    if !maps.iter().all(|v| v.is_finite()) {
        return (f64::NAN, map_gradients);
    }
    let mut sum = 0.0;
    let share = share / (3 * sample.view.paint.at.len() * sample.targets.len()) as f64;
    for (rgb, truth) in &sample.targets {
        for (place, truth) in window.places(&sample.view.paint, sample.placement).zip(truth) {
            for channel in 0..3 {
                let eta = f64::from(rgb[channel]) / 255.0;
                let found = transformer.maps(channel, |i| f64::from(maps[i * pixels + place]));
                let x = transformer.value(found, eta);
                let target = f64::from(truth[channel]);
                sum += share * cross_entropy(x, target);
                let cotangent = share * cross_entropy_derivative(x, target);
                transformer.scatter(channel, transformer.vjp(found, eta, cotangent), |i, v| {
                    map_gradients[i * pixels + place] += v as f32;
                });
            }
        }
    }
    (sum, map_gradients)
}

/// Returns the binary cross-entropy of a prediction and a value from 0 to 1.
fn cross_entropy(x: f64, target: f64) -> f64 {
    let x = x.clamp(1e-4, 1.0 - 1e-4);
    -(target * x.ln() + (1.0 - target) * (1.0 - x).ln())
}

/// Returns the derivative of [`cross_entropy`], (x − t) / (x (1 − x)), bounded near 0 and 1. Beyond them it draws back a value that should not be
/// there; a white that is predicted brighter than white is right.
fn cross_entropy_derivative(x: f64, target: f64) -> f64 {
    let inside = x.clamp(0.0, 1.0);
    (inside - target) / (inside * (1.0 - inside)).max(EDGE * (1.0 - EDGE))
}
