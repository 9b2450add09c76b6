//! Times that detectors take for a photo, measured once and kept in a file, so that reports stay the same bytes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

use image::RgbImage;
use serde::{Deserialize, Serialize};

use super::{DetectError, Detector, Manifest, Runtime};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};

/// Each photo is detected so often; its fastest round counts, which other programs on the machine disturb least.
pub(super) const ROUNDS: u32 = 20;

/// Times of some detectors on one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Speeds {
    /// The machine, as its owner names it.
    pub machine: String,
    /// Version of this program.
    pub scaleproof: String,
    /// Version and build of the ONNX Runtime.
    pub onnx_runtime: String,
    /// Threads of ONNX Runtime.
    pub threads: u32,
    /// How often each photo was detected; the fastest of these rounds counts.
    pub rounds: u32,
    /// How many photos were measured.
    pub photos: usize,
    /// Mean size of these photos.
    pub megapixels: f64,
    /// One entry for each detector.
    pub detectors: Vec<Speed>,
}

/// Time of one detector: from the decoded photo to its boxes, resize and suppression included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Speed {
    pub detector: String,
    /// SHA-256 of the weights, 64 hex digits; `score --speed` refuses times of other weights.
    pub weights_sha256: String,
    /// Median over the photos, from the decoded photo to its boxes.
    pub ms_per_photo: f64,
    /// Times of the fastest and the slowest photo.
    pub ms_range: [f64; 2],
}

impl Speeds {
    /// Times detectors, given with their weights, on decoded photos, one after the other; `on_each` receives each.
    ///
    /// # Errors
    /// A detector that cannot run; those of `on_each`.
    pub fn measure<E: From<DetectError>>(
        machine: String,
        detectors: &[(Manifest, PathBuf)],
        photos: &[RgbImage],
        mut on_each: impl FnMut(&Speed) -> Result<(), E>,
    ) -> Result<Speeds, E> {
        let runtime = Runtime::load()?;
        let pixels = photos.iter().map(|p| f64::from(p.width()) * f64::from(p.height()));
        let megapixels = pixels.sum::<f64>() / 1e4 / photos.len() as f64;
        let mut speeds = Speeds {
            machine,
            scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
            onnx_runtime: runtime.provenance(),
            threads: 1,
            rounds: ROUNDS,
            photos: photos.len(),
            megapixels: megapixels.round() / 100.0,
            detectors: Vec::new(),
        };
        for (manifest, weights) in detectors {
            let speed = measure(runtime, manifest, weights, photos)?;
            on_each(&speed)?;
            speeds.detectors.push(speed);
        }
        Ok(speeds)
    }

    /// Writes a file of times.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        let text = serde_json::to_string_pretty(self).map_err(|e| FileError::content(path, e))?;
        files::write_atomically(path, (text + "\n").as_bytes())
    }

    /// Reads a file of times; those of detectors that are not among `manifests` are passed over.
    pub fn open(path: &Path, manifests: &[&Manifest]) -> Result<Speeds, Message> {
        let shown = path.display();
        let content = |fault: String| message!("{shown} is not a file of `scaleproof detectors speed`: {fault}");
        let mut speeds: Speeds = serde_json::from_str(&files::read_text(path)?).map_err(|e| content(e.to_string()))?;
        let mut names = BTreeSet::new();
        for speed in &speeds.detectors {
            let (name, [fastest, slowest]) = (&speed.detector, speed.ms_range);
            if !names.insert(name) {
                return Err(content(format!("{name} is in it twice")));
            }
            let are_times = fastest > 0.0 && slowest.is_finite() && (fastest..=slowest).contains(&speed.ms_per_photo);
            if !are_times {
                return Err(content(format!("the milliseconds of {name} are no times")));
            }
        }
        let manifest_of = |speed: &Speed| manifests.iter().find(|m| m.name == speed.detector);
        speeds.detectors.retain(|speed| manifest_of(speed).is_some());
        let is_other = |speed: &&Speed| manifest_of(speed).is_some_and(|m| m.weights.sha256 != speed.weights_sha256);
        if let Some(speed) = speeds.detectors.iter().find(is_other) {
            bail!(
                "{shown} was measured with other weights of {}: measure again with `scaleproof detectors speed`",
                speed.detector
            );
        }
        Ok(speeds)
    }

    /// The time of a detector of this name.
    pub fn find(&self, detector: &str) -> Option<&Speed> {
        self.detectors.iter().find(|speed| speed.detector == detector)
    }
}

/// Times one detector on decoded photos, in this thread. At least one photo is needed.
fn measure(runtime: &Runtime, manifest: &Manifest, weights: &Path, photos: &[RgbImage]) -> Result<Speed, DetectError> {
    let mut detector = Detector::open(runtime, manifest, weights)?;
    // The first run of a network also sets it up.
    for photo in photos.iter().take(1) {
        detector.detect(photo)?;
    }
    let mut fastest = Vec::new();
    for photo in photos {
        let mut ms = f64::INFINITY;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            detector.detect(photo)?;
            ms = ms.min(1000.0 * start.elapsed().as_secs_f64());
        }
        // Never 0, however coarse the clock.
        fastest.push((ms * 100.0).round().max(1.0) / 100.0);
    }
    fastest.sort_by(f64::total_cmp);
    let at = |index: usize| fastest.get(index).copied().unwrap_or(f64::NAN);
    Ok(Speed {
        detector: manifest.name.clone(),
        weights_sha256: manifest.weights.sha256.clone(),
        ms_per_photo: at(fastest.len() / 2),
        ms_range: [at(0), at(fastest.len().saturating_sub(1))],
    })
}
