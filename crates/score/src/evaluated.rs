//! A detector that a run evaluates: live, or played back from a recording.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use scaleproof_core::files;
use scaleproof_core::message::{Message, bail, message};
use scaleproof_detect::{
    AnchorLabels, CalledDetector, DetectError, Detection, ForeignCard, Labels, Manifest, NoSuchClass, OutsideError,
    OutsideResults, ProgramDetector, Recorded, RecordedError, Runtime, WeightFolders, WeightsError,
};
use scaleproof_pose::scene::Classes;
use scaleproof_session::Session;

/// A detector of a run.
#[derive(Debug, Clone)]
pub struct EvaluatedDetector {
    /// Description of the detector.
    pub manifest: Manifest,
    /// Source of its detections.
    pub source: DetectionSource,
    /// Labels of the detector that count as the model, by their numbers, at least one.
    pub counted: Vec<usize>,
    /// True if it is tested with the others. One that is not has figures and intervals alone.
    pub is_tested: bool,
}

impl EvaluatedDetector {
    /// Returns true if it may take the whole of a photo of this size, not a reduced one.
    pub(crate) fn looks_at_whole(&self, size: [u32; 2]) -> bool {
        match &self.source {
            DetectionSource::Live(_) => self.manifest.least_px(size[0], size[1]) == size,
            DetectionSource::Program(_) | DetectionSource::Called(_) => true,
            DetectionSource::Recorded(_) | DetectionSource::Outside(_) | DetectionSource::Elsewhere(_) => false,
        }
    }
}

#[derive(Debug, Clone)]
pub enum DetectionSource {
    /// ONNX Runtime runs these weights, whose hash was checked.
    Live(PathBuf),
    /// Detections stored with the sessions.
    Recorded(Vec<Recorded>),
    /// Files that another program wrote.
    Outside(Arc<OutsideResults>),
    Program(Arc<ProgramDetector>),
    /// A function of this process.
    Called(Arc<CalledDetector>),
    /// Another program that was run elsewhere, and is not needed here.
    Elsewhere(Box<ForeignCard>),
}

/// Reason why a detector cannot take part.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluatedDetectorError {
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error(transparent)]
    Recorded(#[from] RecordedError),
    #[error(transparent)]
    NoSuchClass(#[from] NoSuchClass),
    #[error(transparent)]
    Outside(#[from] OutsideError),
    #[error(transparent)]
    Message(#[from] Message),
}

const RECORDED: &str = "recorded";

impl EvaluatedDetector {
    /// Makes a detector that will run, from weights whose hash is checked.
    pub fn live(manifest: Manifest, folders: &WeightFolders, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let source = DetectionSource::Live(folders.checked(&manifest)?);
        EvaluatedDetector::new(manifest, source, class)
    }

    /// Makes a detector that is played back from the recordings of some session folders.
    pub fn recorded(manifest: Manifest, sessions: &[&Path], class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let sessions = sessions.iter();
        let recordings = sessions.map(|folder| Recorded::open(&Self::recordings_of(folder), &manifest));
        let source = DetectionSource::Recorded(recordings.collect::<Result<_, _>>()?);
        EvaluatedDetector::new(manifest, source, class)
    }

    /// Makes a detector that ran elsewhere, for shards: it needs no weights here.
    pub fn ran_elsewhere(manifest: Manifest, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let source = DetectionSource::Live(PathBuf::from(&manifest.weights.file));
        EvaluatedDetector::new(manifest, source, class)
    }

    /// Makes a detector whose detections another program wrote into files.
    pub fn outside(results: OutsideResults, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let manifest = Manifest::of_foreign(results.card());
        EvaluatedDetector::new(manifest, DetectionSource::Outside(Arc::new(results)), class)
    }

    /// Makes a detector that is a program.
    pub fn program(program: ProgramDetector, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let manifest = Manifest::of_foreign(program.card());
        EvaluatedDetector::mapped(manifest, DetectionSource::Program(Arc::new(program)), class)
    }

    /// Makes a detector that is a function of this process.
    pub fn called(function: CalledDetector, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let manifest = Manifest::of_foreign(function.card());
        EvaluatedDetector::mapped(manifest, DetectionSource::Called(Arc::new(function)), class)
    }

    /// Makes a detector whose class map was not read from a manifest, and is checked here.
    fn mapped(manifest: Manifest, source: DetectionSource, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        if let Some(fault) = manifest.class_map_fault() {
            bail!("the manifest of {} is not valid: {fault}", manifest.name);
        }
        EvaluatedDetector::new(manifest, source, class)
    }

    /// Makes a detector of another program that was run elsewhere, for shards.
    pub fn foreign_elsewhere(card: &ForeignCard, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        let source = DetectionSource::Elsewhere(Box::new(card.clone()));
        EvaluatedDetector::new(Manifest::of_foreign(card), source, class)
    }

    /// Returns the description of a detector that another program runs or has run.
    pub fn foreign(&self) -> Option<&ForeignCard> {
        match &self.source {
            DetectionSource::Live(_) | DetectionSource::Recorded(_) => None,
            DetectionSource::Outside(results) => Some(results.card()),
            DetectionSource::Program(program) => Some(program.card()),
            DetectionSource::Called(function) => Some(function.card()),
            DetectionSource::Elsewhere(card) => Some(card),
        }
    }

    /// Returns true if ONNX Runtime runs it.
    pub fn is_live(&self) -> bool {
        matches!(self.source, DetectionSource::Live(_))
    }

    /// Returns the source of its detections, in a word.
    pub fn source_name(&self) -> &'static str {
        match (self.foreign(), self.is_recorded()) {
            (Some(card), _) => card.kind.name(),
            (None, true) => "recorded",
            (None, false) => "live",
        }
    }

    /// Returns the folder of a session's recordings.
    pub fn recordings_of(session: &Path) -> PathBuf {
        session.join(RECORDED)
    }

    fn new(manifest: Manifest, source: DetectionSource, class: &Classes) -> Result<Self, EvaluatedDetectorError> {
        Ok(EvaluatedDetector {
            counted: manifest.counted(class.labels())?,
            manifest,
            source,
            is_tested: true,
        })
    }

    /// Returns true if the detections are played back.
    pub fn is_recorded(&self) -> bool {
        matches!(self.source, DetectionSource::Recorded(_))
    }

    /// Returns true if the label of a detection counts as the model, wherever its box is.
    pub fn counts(&self, detection: &Detection) -> bool {
        self.counted.contains(&detection.label)
    }

    /// Returns the names of its classes.
    pub fn labels(&self) -> Labels {
        self.manifest.labels
    }

    /// Returns the detector's own rule by which labels of a box become detections: `best`, its best alone; `all`, each with its own confidence;
    /// `listed`, as the network lists its boxes; `given`, as another program gives them.
    pub fn box_labels(&self) -> &'static str {
        let head = &self.manifest.head;
        match (self.foreign(), head.with_other_labels(), head.anchor_labels()) {
            (Some(_), ..) => "given",
            (None, None, _) => "listed",
            (None, Some(_), AnchorLabels::Best) => "best",
            (None, Some(_), AnchorLabels::All) => "all",
        }
    }

    /// Returns the SHA-256 of the manifest except its folder, and of the recordings that are played back.
    pub fn fingerprint(&self) -> String {
        let anywhere = Manifest {
            folder: None,
            ..self.manifest.clone()
        };
        let mut recordings = Vec::new();
        if let DetectionSource::Recorded(all) = &self.source {
            recordings.extend(all.iter().map(|r| &r.recording));
        }
        files::sha256_hex(format!("{anywhere:?} {recordings:?}").as_bytes())
    }
}

/// Returns the detectors with the weights in `folders`, or without any played back from the recordings of the sessions.
pub fn evaluated_detectors(
    sessions: &[Session],
    manifests: Vec<Manifest>,
    folders: Option<&WeightFolders>,
) -> Result<Vec<EvaluatedDetector>, EvaluatedDetectorError> {
    let Some(class) = sessions.first().map(|s| &s.scene.model.class) else {
        return Ok(Vec::new());
    };
    let places: Vec<&Path> = sessions.iter().map(|s| s.folder.as_path()).collect();
    let detector = |m| match folders {
        Some(folders) => EvaluatedDetector::live(m, folders, class),
        None => EvaluatedDetector::recorded(m, &places, class),
    };
    manifests.into_iter().map(detector).collect()
}

pub fn runtime(detectors: &[EvaluatedDetector]) -> Result<Option<&'static Runtime>, DetectError> {
    let is_needed = detectors.iter().any(EvaluatedDetector::is_live);
    is_needed.then(Runtime::load).transpose()
}

/// Returns the error of a detector that is played back or cannot take pixels, for photos that are `changed`, as in "made worse".
pub(crate) fn not_changeable(detector: &str, changed: &str) -> Message {
    message!(
        "{detector} cannot look at photos that are {changed}: stored detections and those of other programs are of the photos as they are, and programs \
         must take pixels (\"input\": \"rgb\")"
    )
}
