//! A large run in parts: each shard observes some of the photos, anywhere, and leaves a file; merged, they are the whole run.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::evaluated::{EvaluatedDetector, EvaluatedDetectorError, evaluated_detectors};
use crate::observe::{NotScoredReason, Observation};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};
use scaleproof_detect::{ForeignCard, Manifest};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::{Session, SessionError};

/// Results of a shard: ids of photos, each with its observation or the reason why it was left out.
pub type ShardObservations = Vec<(u64, Result<Observation, NotScoredReason>)>;

/// Number of a shard, by which it takes its photos.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShardId {
    /// Number from 1 to `count`.
    pub index: u64,
    pub count: u64,
}

impl ShardId {
    /// Returns true if the shard has this photo. Photos are dealt like cards, so that every shard gets some of each texture and all take about as
    /// long.
    pub fn holds(&self, photo: u64) -> bool {
        photo % self.count == self.index % self.count
    }

    fn is_there(&self) -> bool {
        (1..=self.count).contains(&self.index)
    }

    /// Parses `2/3`, `slurm`, or `k8s/3`. The environment is read only when it is named.
    pub fn parse(text: &str, environment: impl Fn(&str) -> Option<String>) -> Result<ShardId, Message> {
        let number = |name: &'static str| {
            let not_set = || message!("{name} is not set: this is no such job, write the shard as 2/3");
            let value = environment(name).ok_or_else(not_set)?;
            let number = value.parse::<u64>();
            number.map_err(|_| message!("{name} is {value}, which is no number"))
        };
        let id = match text.split_once('/') {
            None if text == "slurm" => {
                let (first, last) = (number("SLURM_ARRAY_TASK_MIN")?, number("SLURM_ARRAY_TASK_MAX")?);
                let (id, count) = (number("SLURM_ARRAY_TASK_ID")?, number("SLURM_ARRAY_TASK_COUNT")?);
                let steps = last.checked_sub(first).and_then(|steps| steps.checked_add(1));
                if steps != Some(count) {
                    bail!(
                        "the array job counts from {first} to {last} but has {count} tasks: number them without gaps, as in --array=1-{count}"
                    );
                }
                let index = id.checked_sub(first).and_then(|steps| steps.checked_add(1));
                index.map(|index| (index, count))
            }
            Some(("k8s", count)) => {
                let index = number("JOB_COMPLETION_INDEX")?.checked_add(1);
                index.zip(count.parse().ok())
            }
            Some((index, count)) => index.parse().ok().zip(count.parse().ok()),
            None => None,
        };
        let id = id.map(|(index, count)| ShardId { index, count });
        let no_shard = || {
            message!(
                "{text} names no shard: write 2/3 for the second of three, slurm in an array job, or k8s/3 in an indexed job of three"
            )
        };
        id.filter(ShardId::is_there).ok_or_else(no_shard)
    }

    pub fn file_name(&self) -> String {
        format!("shard_{}_of_{}.scaleproof", self.index, self.count)
    }
}

impl fmt::Display for ShardId {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for ShardId {
    type Err = Message;

    fn from_str(text: &str) -> Result<ShardId, Message> {
        ShardId::parse(text, files::environment::text)
    }
}

/// Sessions, detectors and versions that all shards of a run have in common.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Run {
    pub sessions: Vec<SessionSeen>,
    pub detectors: Vec<DetectorUsed>,
    /// True if detections were played back.
    pub is_recorded: bool,
    /// Version and build of the ONNX Runtime, if one ran.
    pub runtime: Option<String>,
    /// Versions of the other libraries.
    pub libraries: String,
}

impl Run {
    /// Describes a run of detectors over sessions; `chosen_as` has the name or the manifest that chooses each detector again.
    pub fn of(
        sessions: &[Session],
        detectors: &[EvaluatedDetector],
        chosen_as: Vec<String>,
        runtime: Option<String>,
    ) -> Result<Run, FileError> {
        let used = |(chosen_as, detector): (String, &EvaluatedDetector)| DetectorUsed {
            chosen_as,
            fingerprint: detector.fingerprint(),
            foreign: detector.foreign().cloned(),
        };
        Ok(Run {
            sessions: sessions.iter().map(SessionSeen::new).collect::<Result<_, _>>()?,
            detectors: chosen_as.into_iter().zip(detectors).map(used).collect(),
            is_recorded: detectors.iter().all(|d| d.is_recorded() || d.foreign().is_some()),
            runtime,
            libraries: TagDetectorChoice::default().provenance(),
        })
    }

    /// Opens the sessions as they were when the shards were scored, with the same libraries.
    pub fn sessions(&self) -> Result<Vec<Session>, ShardError> {
        let (theirs, own) = (self.libraries.clone(), TagDetectorChoice::default().provenance());
        if theirs != own {
            bail!("the shards were scored with {theirs}, and here is {own}: merge where they were scored");
        }
        self.sessions.iter().map(SessionSeen::opened).collect()
    }

    /// Returns the names and manifests that choose the detectors that are networks again.
    pub fn chosen(&self) -> Vec<String> {
        let networks = self.detectors.iter().filter(|used| used.foreign.is_none());
        networks.map(|used| used.chosen_as.clone()).collect()
    }

    /// Returns the detectors as they were, given the manifests of those that are networks; they need no weights here.
    pub fn detectors(
        &self,
        manifests: Vec<Manifest>,
        sessions: &[Session],
    ) -> Result<Vec<EvaluatedDetector>, ShardError> {
        let Some(class) = sessions.first().map(|s| &s.scene.model.class) else {
            return Ok(Vec::new());
        };
        let elsewhere = |manifest| EvaluatedDetector::ran_elsewhere(manifest, class);
        let networks: Vec<EvaluatedDetector> = if self.is_recorded {
            evaluated_detectors(sessions, manifests, None)?
        } else {
            manifests.into_iter().map(elsewhere).collect::<Result<_, _>>()?
        };
        let mut networks = networks.into_iter();
        let mut detectors = Vec::new();
        for used in &self.detectors {
            detectors.extend(match &used.foreign {
                Some(card) => Some(EvaluatedDetector::foreign_elsewhere(card, class)?),
                None => networks.next(),
            });
        }
        let fingerprints = detectors.iter().map(EvaluatedDetector::fingerprint);
        if fingerprints.eq(self.detectors.iter().map(|used| used.fingerprint.clone())) {
            Ok(detectors)
        } else {
            bail!("a manifest or a recording has changed since the shards were scored: score them again")
        }
    }
}

/// A session, and the hashes of its files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SessionSeen {
    pub folder: PathBuf,
    /// File name and SHA-256 of `session.json` and the files it names.
    pub hashes: Vec<(String, String)>,
}

impl SessionSeen {
    fn new(session: &Session) -> Result<SessionSeen, FileError> {
        Ok(SessionSeen {
            folder: files::whole_path(&session.folder)?,
            hashes: session.hashes.clone(),
        })
    }

    fn opened(&self) -> Result<Session, ShardError> {
        let session = Session::open(&self.folder)?;
        if session.hashes == self.hashes {
            Ok(session)
        } else {
            let folder = self.folder.display();
            bail!("{folder} has changed since the shards were scored: score them again")
        }
    }
}

/// A detector: its choice, and its fingerprint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DetectorUsed {
    /// The name or the manifest that chooses it again.
    pub chosen_as: String,
    /// SHA-256 of its manifest, which names the weights by theirs, and of what was played back.
    pub fingerprint: String,
    /// Description of one that another program runs or has run.
    pub foreign: Option<ForeignCard>,
}

/// One shard's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shard {
    pub run: Run,
    pub id: ShardId,
    pub observed: ShardObservations,
}

/// Reason why shards are not one run.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Detector(#[from] EvaluatedDetectorError),
    #[error("{path} is damaged: copy it again, or score that shard again", path = path.display())]
    Damaged { path: PathBuf },
    #[error("the shard cannot be written: {0}")]
    Write(#[from] postcard::Error),
    #[error(transparent)]
    Message(#[from] Message),
}

const MISSING_NAMED: usize = 5;

fn list_of(indices: &[u64]) -> String {
    let first: Vec<String> = indices.iter().take(MISSING_NAMED).map(u64::to_string).collect();
    let more = if indices.len() > first.len() {
        ", and others"
    } else {
        ""
    };
    format!("{}{more}", first.join(", "))
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Head of a shard file, which goes on with the version, a line with the SHA-256 of the rest, and the rest.
const MAGIC: &str = "scaleproof shard, version ";

impl Shard {
    pub fn write(&self, folder: &Path) -> Result<PathBuf, ShardError> {
        let content = postcard::to_allocvec(self)?;
        let head = format!("{MAGIC}{VERSION}\n{}\n", files::sha256_hex(&content));
        let path = folder.join(self.id.file_name());
        files::replace_atomically(folder, &path, &[head.into_bytes(), content].concat())?;
        Ok(path)
    }

    /// Reads a shard and makes sure that it is whole and of this version.
    pub fn open(path: &Path) -> Result<Shard, ShardError> {
        let bytes = files::read(path)?;
        let shown = path.display();
        let after_magic = bytes.strip_prefix(MAGIC.as_bytes());
        let head = after_magic.and_then(line);
        let (version, rest) =
            head.ok_or_else(|| message!("{shown} is not a shard").hint("name the files that score ‹shard› wrote"))?;
        if version != VERSION {
            bail!(
                "{shown} was written by scaleproof {version}, and this is {VERSION}: score it again, or merge with that version"
            );
        }
        let whole = line(rest).filter(|(sum, content)| *sum == files::sha256_hex(content));
        whole
            .and_then(|(_, content)| postcard::from_bytes(content).ok())
            .filter(|shard: &Shard| shard.id.is_there())
            .ok_or_else(|| ShardError::Damaged { path: path.to_owned() })
    }
}

/// Returns the first line as text, and what follows it.
fn line(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let end = bytes.iter().take(100).position(|b| *b == b'\n')?;
    Some((std::str::from_utf8(&bytes[..end]).ok()?, &bytes[end + 1..]))
}

/// A run that some shards are all of, and its observations by photo id.
pub type WholeRun = (Run, BTreeMap<u64, Result<Observation, NotScoredReason>>);

/// Puts the shards of one run together: every one once, and none of another run.
pub fn whole_run(paths: &[PathBuf]) -> Result<WholeRun, ShardError> {
    let mut run: Option<Run> = None;
    let (mut seen, mut observed) = (BTreeMap::<u64, &PathBuf>::new(), BTreeMap::new());
    let mut count = 0;
    for path in paths {
        let shard = Shard::open(path)?;
        match &run {
            None => (run, count) = (Some(shard.run), shard.id.count),
            Some(first) => {
                if let Some(what) = difference(first, &shard.run, count, shard.id.count) {
                    let (a, b) = (paths[0].display(), path.display());
                    bail!("{a} and {b} are of different runs ({what} differ): merge the shards of one run only");
                }
            }
        }
        if let Some(same) = seen.insert(shard.id.index, path) {
            let (a, b) = (same.display(), path.display());
            bail!("{a} and {b} are the same shard: name each once");
        }
        observed.extend(shard.observed);
    }
    let run = run.ok_or_else(|| message!("no shard to merge"))?;
    // One more than are named: a mistyped count may be any number.
    let missing = (1..=count).filter(|index| !seen.contains_key(index));
    let missing: Vec<u64> = missing.take(MISSING_NAMED + 1).collect();
    if missing.is_empty() {
        return Ok((run, observed));
    }
    let (found, missing) = (seen.len(), list_of(&missing));
    bail!("{found} of {count} shards are here; missing: {missing} (score what is missing and merge all)")
}

fn difference(a: &Run, b: &Run, a_count: u64, b_count: u64) -> Option<&'static str> {
    let same_detectors = a.detectors == b.detectors && a.is_recorded == b.is_recorded;
    let checks = [
        (a_count == b_count, "their numbers of shards"),
        (a.sessions == b.sessions, "their sessions, scenes or cameras"),
        (same_detectors, "their detectors"),
        (a.runtime == b.runtime, "their ONNX Runtimes"),
        (a.libraries == b.libraries, "their libraries"),
    ];
    checks.into_iter().find(|(same, _)| !same).map(|(_, what)| what)
}
