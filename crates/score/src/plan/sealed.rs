//! The plan and its file.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::figures::{ClusteredBy, PlanCheck};
use crate::plan::Spread;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_detect::{Manifest, ManifestError};
use scaleproof_pose::scene::Classes;

/// Plan of an experiment, fixed before its photos are taken.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SealedPlan {
    /// Version of the program that sealed it.
    pub scaleproof: String,
    /// The texture that drops are measured from.
    pub base: String,
    /// SHA-256 of each texture's pattern, by the texture's name; `null` for a texture without one.
    pub textures: BTreeMap<String, Option<String>>,
    /// Labels that count as the model.
    pub classes: Classes,
    /// The definition of average precision: `coco-101`, `all-point`, `voc-11` or `yolov5-ramp`.
    pub ap: String,
    /// Confidence from which a detection counts as a hit.
    pub hit_confidence: f64,
    /// IoU with the truth box from which a detection is on the model.
    pub match_iou: f64,
    /// Name of the protocol that is followed; `null` for none.
    pub protocol: Option<String>,
    /// The detectors, by name.
    pub detectors: BTreeMap<String, SealedDetector>,
    /// SHA-256 of the scene's file.
    pub scene_sha256: String,
    /// SHA-256 of the mesh that the scene names; `null` without one.
    pub mesh_sha256: Option<String>,
    /// SHA-256 of the camera's file; `null` where it is not fixed.
    pub camera_sha256: Option<String>,
    /// Azimuth and pitch (degrees) and distance (mm) of the bins that are photographed in every texture at every place.
    pub views: Vec<[f64; 3]>,
    /// Number of places that are photographed.
    pub places: u16,
    pub stopping: Stopping,
    /// Aim of the experiment; `null` in plans of versions that did not state it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aim: Option<Aim>,
}

/// Effect that an experiment is to show, and how surely.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Aim {
    /// The figure that decides; others are beside it.
    pub primary_endpoint: Endpoint,
    /// The drop of the primary endpoint that shall be shown.
    pub drop: f64,
    /// The hit rate that is expected of the base; in plans for the hit rate alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_rate: Option<f64>,
    /// Probability with which such a drop shall be shown.
    pub power: f64,
    /// Detectors × textures that are held against the base.
    pub comparisons: usize,
    /// Number of places that show the drop of one of them so often. `null` where no number of photos that anyone takes does.
    pub places_needed: Option<usize>,
    /// Assumed scatter of the differences; in plans for the mean confidence alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<Spread>,
}

/// Figure and test that decide a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Endpoint {
    /// Mean confidence of the strongest detection that counts as the model, by flipped signs of the views; looked at sequentially, by bets.
    MeanConfidence,
    /// Share of the photos with a detection of the model at the plan's confidence and IoU, by McNemar's exact test.
    HitRate,
}

/// Hashes by which a detector is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SealedDetector {
    pub weights_sha256: String,
    /// SHA-256 of the manifest, which says how photos are fed, and how answers are read.
    pub manifest_sha256: String,
}

/// Rule by which the photos are enough.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Stopping {
    /// Once every view is there; the result is looked at once.
    EveryView,
    /// Once the sequential test shows something.
    Decided {
        /// Unit that is added between two looks.
        look_after_each: ClusteredBy,
        /// The drop that matters; `null` where none is named.
        least: Option<f64>,
    },
}

/// The file: the plan, and the SHA-256 of the plan as it was.
#[derive(Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SealedFile {
    /// SHA-256 of `plan`, without blanks between its parts.
    seal: String,
    plan: SealedPlan,
}

/// Reason why a plan cannot be sealed or read.
#[derive(Debug, thiserror::Error)]
pub enum SealError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error("the plan cannot be written: {0}")]
    Unwritable(#[from] serde_json::Error),
    #[error(transparent)]
    Message(#[from] Message),
}

const MOST_BYTES: u64 = 4 << 20;

impl SealedDetector {
    pub fn of(manifest: &Manifest) -> Result<SealedDetector, ManifestError> {
        Ok(SealedDetector {
            weights_sha256: manifest.weights.sha256.clone(),
            manifest_sha256: files::sha256_hex(manifest.to_toml()?.as_bytes()),
        })
    }
}

impl SealedPlan {
    pub fn photos(&self) -> usize {
        self.textures.len() * self.views.len() * usize::from(self.places)
    }

    fn seal(&self) -> Result<String, SealError> {
        Ok(files::sha256_hex(serde_json::to_string(self)?.as_bytes()))
    }

    /// Writes a new file, and returns its seal.
    pub fn write(self, path: &Path) -> Result<String, SealError> {
        if path.exists() {
            let path = path.display();
            bail!("{path} is there already, and a sealed plan is not changed: name another file");
        }
        let (seal, plan) = (self.seal()?, self);
        let file = SealedFile { seal, plan };
        let text = serde_json::to_string_pretty(&file)? + "\n";
        files::write_atomically(path, text.as_bytes())?;
        Ok(file.seal)
    }

    /// Reads a plan; the seal is that of its content, and a deviation says when the file states another.
    pub fn read(path: &Path) -> Result<(SealedPlan, PlanCheck), SealError> {
        let bytes = files::read_at_most(path, MOST_BYTES)?;
        let refused = |reason: String| message!("{} is no sealed plan: {reason}", path.display());
        let place = |e: serde_json::Error| format!("line {}, column {}, does not read as one", e.line(), e.column());
        let file: SealedFile = serde_json::from_slice(&bytes).map_err(|e| refused(place(e)))?;
        if file.plan.views.iter().flatten().any(|number| number.abs() > 1e6) {
            return Err(refused("a view of it lies beyond any bin".into()).into());
        }
        let seal = file.plan.seal()?;
        let mut deviations = Vec::new();
        if file.seal != seal {
            let changed = "the plan was changed after it was sealed: the seal in its file is not that of its content";
            deviations.push(changed.to_owned());
        }
        let check = PlanCheck {
            seal,
            judged_by_hit_rate: file.plan.endpoint() == Endpoint::HitRate,
            deviations,
        };
        Ok((file.plan, check))
    }
}

impl Stopping {
    /// Returns the unit after which one looks, and the least drop that matters; `None` where one looks once.
    pub fn looks(self) -> Option<(ClusteredBy, Option<f64>)> {
        match self {
            Stopping::EveryView => None,
            Stopping::Decided { look_after_each, least } => Some((look_after_each, least)),
        }
    }

    pub(crate) fn in_words(self) -> String {
        match self {
            Stopping::EveryView => "when every view is there".into(),
            Stopping::Decided { look_after_each, least } => {
                let unit = match look_after_each {
                    ClusteredBy::Place => "place",
                    ClusteredBy::PlaceAndBin => "pair",
                };
                let least = least.map_or_else(String::new, |least| format!(" or a drop of {least} is excluded"));
                format!("when it is decided after a {unit}{least}")
            }
        }
    }
}
