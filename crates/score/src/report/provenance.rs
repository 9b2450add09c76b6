//! Provenance of a result: enough to repeat it, or to see why a repetition differs.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::evaluated::{DetectionSource, EvaluatedDetector};
use crate::figures::{AppliedSettings, Protocol, Scores, TexturePattern};
use crate::report::words::counted;
use scaleproof_core::files;
use scaleproof_detect::{Recorded, SCORE_FLOOR};

#[derive(Serialize, schemars::JsonSchema)]
pub(crate) struct Provenance {
    /// Version of the program.
    pub scaleproof: &'static str,
    /// Version and build of ONNX Runtime; `null` when no detector was run.
    pub onnx_runtime: Option<String>,
    /// Name and library of the tag detector.
    pub tag_detector: String,
    /// With `--settings`: the file that changed how photos are located or figures computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<AppliedSettings>,
    /// Definition of AP@0.5: `coco-101`, `all-point`, `voc-11` or `yolov5-ramp`.
    pub ap_definition: &'static str,
    /// Name of the protocol whose definitions and thresholds these are; `null` for none.
    pub protocol: Option<&'static str>,
    /// IoU with the truth box from which a detection is on the model: 0.5, or as the protocol has it.
    pub match_iou: f64,
    /// Confidence from which a detection counts as a hit.
    pub hit_confidence: f64,
    /// Confidence from which detections are kept.
    pub score_floor: f64,
    /// The detectors, and where their detections come from.
    pub detectors: Vec<DetectorProvenance>,
    /// The sessions, with the hashes of their files.
    pub sessions: Vec<SessionProvenance>,
    /// The textures whose patterns are known (`--pattern`).
    pub patterns: Vec<TexturePattern>,
}

#[derive(Serialize, schemars::JsonSchema)]
pub(crate) struct DetectorProvenance {
    /// Name in the manifest, which also gives `title`, `origin` and `licence`.
    pub name: String,
    pub title: String,
    /// SHA-256 of the weights, as in the manifest; `null` when another program ran the detector.
    pub weights_sha256: Option<String>,
    /// Version that another program states of itself, where it does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
    /// SHA-256 by name, of the files of another program, where it names some.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
    /// Its labels that count as the model.
    pub counted_labels: Vec<&'static str>,
    pub origin: String,
    pub licence: String,
    /// Source of its detections: `live`, `recorded`, `results` (files of another program), `program` or `function` (of Python).
    pub source: &'static str,
    /// Program and runtime that made the recording; `null` where there is none.
    pub recorded_by: Option<String>,
}

#[derive(Serialize, schemars::JsonSchema)]
pub(crate) struct SessionProvenance {
    /// Name of the session's folder.
    pub folder: String,
    /// Name of the model; its `scale` is 10 for 1:10.
    pub model: String,
    pub scale: f64,
    /// Places of the scored photos, each once.
    pub places: Vec<String>,
    /// Times of the first and the last scored photo, as the session or EXIF says; `null` where neither does.
    pub taken: Option<[String; 2]>,
    /// Name of the camera file; `null` without one.
    pub camera: Option<String>,
    /// `box`, `hull` or `mesh`: what truth boxes are drawn around where the session gives none.
    pub truth_envelope: &'static str,
    /// Name of the mesh's file, whose hash is in `files`; `null` without a mesh.
    pub truth_mesh: Option<String>,
    /// SHA-256 by file name: session, scene, mesh, camera and photos.
    pub files: BTreeMap<String, String>,
}

pub(crate) fn from_scores(scores: &Scores) -> Provenance {
    Provenance {
        scaleproof: env!("CARGO_PKG_VERSION"),
        onnx_runtime: scores.runtime.clone(),
        tag_detector: scores.tags.provenance(),
        settings: scores.settings.clone(),
        ap_definition: scores.criteria.ap.name(),
        protocol: scores.criteria.protocol.map(Protocol::name),
        match_iou: scores.criteria.match_iou(),
        hit_confidence: scores.criteria.hit_confidence,
        score_floor: SCORE_FLOOR,
        detectors: scores.detectors.iter().map(detector).collect(),
        sessions: (0..scores.sessions.len()).map(|i| session(scores, i)).collect(),
        patterns: scores.patterns.clone(),
    }
}

fn detector(c: &EvaluatedDetector) -> DetectorProvenance {
    let by = |r: &Recorded| format!("scaleproof {}, {}", r.recording.scaleproof, r.recording.runtime);
    let recorded_by = match &c.source {
        DetectionSource::Recorded(recordings) => recordings.first().map(by),
        _ => None,
    };
    let foreign = c.foreign();
    DetectorProvenance {
        name: c.manifest.name.clone(),
        title: c.manifest.title.clone(),
        weights_sha256: foreign.is_none().then(|| c.manifest.weights.sha256.clone()),
        version: foreign.and_then(|card| card.version.clone()),
        files: foreign.map_or_else(BTreeMap::new, |card| by_name(&card.files)),
        counted_labels: counted::labels_of(c),
        origin: c.manifest.origin.clone(),
        licence: c.manifest.licence.clone(),
        source: c.source_name(),
        recorded_by,
    }
}

/// Returns hashes by the names of their files; the second of a name is “name (2)”.
fn by_name(files: &[(String, String)]) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for (name, hash) in files {
        let numbered = (2..).map(|n| format!("{name} ({n})"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        let free = names.find(|name| !all.contains_key(name));
        all.extend(free.map(|name| (name, hash.clone())));
    }
    all
}

fn session(scores: &Scores, index: usize) -> SessionProvenance {
    let session = &scores.sessions[index];
    let own = || scores.photos.iter().filter(|p| p.session == index);
    let photos = own().map(|p| (p.file.clone(), p.sha256.clone()));
    let places: BTreeSet<&String> = own().filter_map(|p| p.place.as_ref()).collect();
    let taken = || own().filter_map(|p| p.taken.clone());
    SessionProvenance {
        folder: session.name.clone(),
        model: session.scene.model.name.clone(),
        scale: session.scene.model.scale,
        places: places.into_iter().cloned().collect(),
        taken: taken().min().zip(taken().max()).map(<[String; 2]>::from),
        camera: session.camera_path.as_deref().map(files::name_of),
        truth_envelope: session.scene.model.envelope.name(),
        truth_mesh: session.scene.model.envelope.mesh().map(files::name_of),
        files: session.hashes.iter().cloned().chain(photos).collect(),
    }
}
