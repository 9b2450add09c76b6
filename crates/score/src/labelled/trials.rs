//! Trials of a detector's manifest with one thing changed at a time, to explain a figure that is not the published one.

use serde::Serialize;

use crate::labelled::feeding::feedings;
use crate::labelled::photos::PhotoDetections;
use crate::labelled::{Averages, LabelledError, LabelledPhotos};
use scaleproof_detect::Manifest;

/// Least gain of a change that explains a difference, beyond the chance of the photos too.
pub const LEAST_GAIN: f64 = 0.02;

/// The manifest with one thing changed at a time.
#[derive(Serialize, schemars::JsonSchema)]
pub struct Trials {
    /// Photos of the trials.
    pub photos: usize,
    /// Averages of these photos.
    pub as_the_manifest_says: Averages,
    pub changed: Vec<Trial>,
    /// Of the changes that gain enough, the one that reaches the most.
    pub explained_by: Option<String>,
}

#[derive(Serialize, schemars::JsonSchema)]
pub struct Trial {
    /// Change of the manifest.
    pub change: String,
    pub averages: Averages,
    /// Lower end of the 95 % interval of its gain in AP@[.5:.95]; `null` with fewer than six photos.
    pub least_gain: Option<f64>,
}

/// Tries every single change of a manifest on a sample of photos, on which `look` runs the detector under a title; `None` when they have no object
/// that counts.
pub fn trials(
    manifest: &Manifest,
    sample: &LabelledPhotos,
    look: &dyn Fn(&LabelledPhotos, &Manifest, &str) -> Result<PhotoDetections, LabelledError>,
) -> Result<Option<Trials>, LabelledError> {
    let found = look(sample, manifest, "as it is")?;
    let Some(base) = sample.averages(&found, 0) else {
        return Ok(None);
    };
    let mut changed = Vec::new();
    for feeding in feedings(manifest) {
        let fed_otherwise = match feeding.shift {
            0 => look(sample, &feeding.manifest, &feeding.what)?,
            _ => found.clone(),
        };
        let Some(averages) = sample.averages(&fed_otherwise, feeding.shift) else {
            return Ok(None);
        };
        let least_gain = sample.least_gain(&found, &fed_otherwise, feeding.shift);
        let change = feeding.what;
        changed.push(Trial {
            change,
            averages,
            least_gain,
        });
    }
    changed.sort_by(|a, b| b.averages.ap_50_95.total_cmp(&a.averages.ap_50_95));
    let explains = |trial: &&Trial| {
        trial.least_gain.is_some_and(|gain| gain >= LEAST_GAIN) && trial.averages.ap_50_95 >= base.ap_50_95 + LEAST_GAIN
    };
    Ok(Some(Trials {
        photos: sample.photos.len(),
        as_the_manifest_says: base,
        explained_by: changed.iter().find(explains).map(|trial| trial.change.clone()),
        changed,
    }))
}
