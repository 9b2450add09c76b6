//! Detections in files: COCO results JSON, and recordings that remember which weights and photos they came from.
//!
//! A recording is two files: `NAME.json`, a plain COCO results list, and `NAME.provenance.json`.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::choose::names_in;
use super::{Detection, Manifest};
use scaleproof_core::files;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::{Message, bail, message};

/// One detection of a COCO results file (cocodataset.org, "Results format").
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CocoResult {
    pub image_id: u64,
    pub category_id: u32,
    /// x, y, width, height in pixels.
    pub bbox: [f64; 4],
    pub score: f64,
}

/// COCO results JSON of some photos, given as (image id, detections); one result a line. `category_id` says which category a label is
/// written as; labels without one are left out.
pub fn coco_results<'a>(
    photos: impl IntoIterator<Item = (u64, &'a [Detection])>,
    category_id: impl Fn(usize) -> Option<u32>,
) -> serde_json::Result<String> {
    let mut text = String::from("[");
    for (image_id, detections) in photos {
        for d in detections {
            // A label outside the map cannot come from `Detector`, and a file cannot name it.
            let Some(category_id) = category_id(d.label) else {
                continue;
            };
            let line = CocoResult {
                image_id,
                category_id,
                bbox: d.to_xywh(),
                score: d.score,
            };
            text.push_str(if text.len() == 1 { "\n" } else { ",\n" });
            text.push_str(&serde_json::to_string(&line)?);
        }
    }
    // Without a result the list is an empty line.
    text.push_str(if text.len() == 1 { "\n\n]\n" } else { "\n]\n" });
    Ok(text)
}

/// The provenance of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    pub detector: String,
    /// SHA-256 of the weights, hex.
    pub weights_sha256: String,
    /// SHA-256 of the results file, hex: the two belong together.
    pub results_sha256: String,
    /// Version of this program.
    pub scaleproof: String,
    /// Version and build of the ONNX Runtime.
    pub runtime: String,
    pub score_floor: f64,
    pub photos: Vec<RecordedPhoto>,
}

/// A photo of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedPhoto {
    /// The `image_id` of its results.
    pub id: u64,
    pub file: String,
    pub sha256: String,
}

impl Recording {
    /// Reads where a detector's recording in a folder came from, and nothing else of it.
    pub fn open(folder: &Path, detector: &str) -> Result<Recording, RecordedError> {
        let (_, path) = paths(folder, detector);
        Ok(parse(&files::read_text(&path)?, &path)?)
    }

    /// Returns whether a folder has a detector's recording, or half of one.
    pub fn is_in(folder: &Path, detector: &str) -> bool {
        let (results, provenance) = paths(folder, detector);
        results.exists() || provenance.exists()
    }

    /// The detectors that a folder has recordings of, by name; none when there is no such folder.
    pub fn names_in(folder: &Path) -> Vec<String> {
        names_in(folder, PROVENANCE)
    }
}

const PROVENANCE: &str = ".provenance.json";

/// Why a recording cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordedError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Stored detections of a session, by the SHA-256 of the photo.
#[derive(Debug, Clone)]
pub struct Recorded {
    pub recording: Recording,
    by_photo: BTreeMap<String, Vec<Detection>>,
}

impl Recorded {
    pub fn open(folder: &Path, manifest: &Manifest) -> Result<Recorded, RecordedError> {
        let (results_path, provenance_path) = paths(folder, &manifest.name);
        let recording: Recording = parse(&files::read_text(&provenance_path)?, &provenance_path)?;
        if recording.weights_sha256 != manifest.weights.sha256 {
            let (path, name, found) = (provenance_path.display(), &manifest.name, &recording.weights_sha256);
            bail!("{path} was recorded with other weights of {name} (SHA-256 {found:.12}…): record it again");
        }
        let text = files::read_text(&results_path)?;
        let is_same = files::sha256_hex(text.as_bytes()) == recording.results_sha256;
        if !is_same || recording.detector != manifest.name {
            bail!(
                "{} is not the recording of {} that its provenance describes", results_path.display(), manifest.name;
                hint: "record it again with ‹record›"
            );
        }
        let results: Vec<CocoResult> = parse(&text, &results_path)?;
        let by_id: BTreeMap<u64, &str> = recording.photos.iter().map(|p| (p.id, p.sha256.as_str())).collect();
        let none = |photo: &RecordedPhoto| (photo.sha256.clone(), Vec::new());
        let mut by_photo: BTreeMap<String, Vec<Detection>> = recording.photos.iter().map(none).collect();
        for CocoResult {
            image_id,
            category_id,
            bbox: [x, y, w, h],
            score,
        } in results
        {
            let detections = by_id.get(&image_id).and_then(|sha256| by_photo.get_mut(*sha256));
            let Some(detections) = detections else {
                let fault = format!("image_id {image_id} has no photo in its provenance");
                return Err(unreadable(&results_path, fault).into());
            };
            let label = manifest
                .labels
                .of_category(category_id)
                .filter(|_| (0.0..=1.0).contains(&score));
            let detection = label.and_then(|label| Detection::new(label, score, BoxPx::new(x, y, x + w, y + h)));
            detections.push(detection.ok_or_else(|| {
                let message = format!("a result of image {image_id} has no valid box, score or category");
                unreadable(&results_path, message)
            })?);
        }
        Ok(Recorded { recording, by_photo })
    }

    /// Writes a recording; `detections` are in the order of `recording.photos`, and its `results_sha256` is filled in.
    pub fn save(
        folder: &Path,
        manifest: &Manifest,
        recording: Recording,
        detections: &[&[Detection]],
    ) -> Result<(), RecordedError> {
        let (results_path, provenance_path) = paths(folder, &manifest.name);
        let syntax = |e: serde_json::Error| unreadable(&results_path, e);
        let photos = recording.photos.iter().map(|p| p.id).zip(detections.iter().copied());
        let results = coco_results(photos, |label| manifest.labels.category_id(label)).map_err(syntax)?;
        let recording = Recording {
            results_sha256: files::sha256_hex(results.as_bytes()),
            ..recording
        };
        let provenance = serde_json::to_string_pretty(&recording).map_err(syntax)? + "\n";
        files::replace_atomically(folder, &results_path, results.as_bytes())?;
        files::replace_atomically(folder, &provenance_path, provenance.as_bytes())?;
        Ok(())
    }

    /// The stored detections of a photo; `None` when this very file was not recorded.
    pub fn of_photo(&self, sha256: &str) -> Option<&[Detection]> {
        self.by_photo.get(sha256).map(Vec::as_slice)
    }
}

fn paths(folder: &Path, name: &str) -> (PathBuf, PathBuf) {
    (
        folder.join(format!("{name}.json")),
        folder.join(format!("{name}{PROVENANCE}")),
    )
}

fn parse<T: serde::de::DeserializeOwned>(text: &str, path: &Path) -> Result<T, Message> {
    serde_json::from_str(text).map_err(|e| unreadable(path, e))
}

fn unreadable(path: &Path, fault: impl Display) -> Message {
    message!("{} is not a recording of detections: {fault}", path.display())
}
