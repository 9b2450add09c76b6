//! A detector that takes part in a scoring run: live, or played back from a recording.

use std::path::{Path, PathBuf};

use crate::detect::{Detection, Labels, Manifest, NoSuchClass, Recorded, RecordedError, WeightFolders, WeightsError};
use crate::scene::Classes;

/// A detector of a run.
#[derive(Debug, Clone)]
pub struct Contestant {
    pub manifest: Manifest,
    pub source: Source,
    /// The detector's labels that count as the model, by their numbers, at least one.
    pub counted: Vec<usize>,
}

/// Where a contestant's detections come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// ONNX Runtime runs these weights, whose hash was checked.
    Live(PathBuf),
    /// Detections stored with the sessions.
    Recorded(Vec<Recorded>),
}

/// Why a detector cannot take part.
#[derive(Debug, thiserror::Error)]
pub enum ContestantError {
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error(transparent)]
    Recorded(#[from] RecordedError),
    #[error(transparent)]
    NoSuchClass(#[from] NoSuchClass),
}

/// The folder of a session that holds recordings.
const RECORDED: &str = "recorded";

impl Contestant {
    /// A detector that will run.
    pub fn live(manifest: Manifest, folders: &WeightFolders, class: &Classes) -> Result<Contestant, ContestantError> {
        let source = Source::Live(folders.checked(&manifest)?);
        Contestant::new(manifest, source, class)
    }

    /// A detector played back from the recordings of some session folders.
    pub fn recorded(manifest: Manifest, sessions: &[&Path], class: &Classes) -> Result<Contestant, ContestantError> {
        let recordings = sessions
            .iter()
            .map(|folder| Recorded::open(&folder.join(RECORDED), &manifest));
        let source = Source::Recorded(recordings.collect::<Result<_, _>>()?);
        Contestant::new(manifest, source, class)
    }

    /// A detector that ran elsewhere, for shards: it needs no weights here.
    pub fn ran_elsewhere(manifest: Manifest, class: &Classes) -> Result<Contestant, ContestantError> {
        let source = Source::Live(PathBuf::from(&manifest.weights.file));
        Contestant::new(manifest, source, class)
    }

    /// Where a session's recordings lie.
    pub fn recordings_of(session: &Path) -> PathBuf {
        session.join(RECORDED)
    }

    fn new(manifest: Manifest, source: Source, class: &Classes) -> Result<Contestant, ContestantError> {
        Ok(Contestant {
            counted: manifest.counted(class.labels())?,
            manifest,
            source,
        })
    }

    /// True when the detections are played back.
    pub fn is_recorded(&self) -> bool {
        matches!(self.source, Source::Recorded(_))
    }

    /// Whether a detection counts as the model, wherever it is.
    pub fn counts(&self, detection: &Detection) -> bool {
        self.counted.contains(&detection.label)
    }

    pub fn labels(&self) -> Labels {
        self.manifest.labels
    }
}
