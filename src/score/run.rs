//! A scoring run: every photo of some sessions through pose, truth and detectors, in parallel.

use std::collections::BTreeMap;

use super::observe::{Job, Observation, Observer, Options, Place, place};
use super::{
    Contestant, Criteria, HIT_CONFIDENCE, NotScored, Outcome, ScoredPhoto, Summary, TagMark, caution, shard, summary,
};
use crate::detect::{DetectError, Runtime};
use crate::locate::Located;
use crate::session::Session;
use crate::tags::{SeenTag, StartError, TagDetectorChoice};
use crate::workers;

/// Why a run could not finish. Bad photos are no reason: they are listed in [`Scores::not_scored`].
#[derive(Debug, thiserror::Error)]
pub enum ScoreError {
    #[error("no session to score")]
    NoSession,
    #[error("{a} and {b} have different bins or model classes: score them in separate runs")]
    DifferentScenes { a: String, b: String },
    #[error("the session {folder} is named twice: each photo counts once")]
    SessionTwice { folder: String },
    #[error("{file} has no recorded detections of {detector}")]
    NotRecorded { file: String, detector: String },
    #[error("none of the {photos} photos could be scored; {file}, for one: {reason}")]
    NothingScored {
        photos: usize,
        file: String,
        reason: String,
    },
    #[error("the shards do not hold {file} of {session}: score them again")]
    NotObserved { session: String, file: String },
    #[error(transparent)]
    Detect(#[from] DetectError),
    #[error(transparent)]
    Tags(#[from] StartError),
}

/// The result of a run.
#[derive(Debug)]
pub struct Scores {
    pub sessions: Vec<Session>,
    pub contestants: Vec<Contestant>,
    /// In the order of the sessions' lists.
    pub photos: Vec<ScoredPhoto>,
    pub not_scored: Vec<NotScored>,
    /// Per contestant and variant, contestants first.
    pub summaries: Vec<Summary>,
    /// What the figures depend on; see [`Scores::judged_by`].
    pub criteria: Criteria,
    /// What a reader must know before believing the figures, as sentences.
    pub cautions: Vec<String>,
    /// Version and build of the ONNX Runtime; `None` when every contestant was played back.
    pub runtime: Option<String>,
}

/// Scores every photo of the sessions with every contestant, by the default criteria. `on_photo` is called after each photo.
pub fn score(
    sessions: Vec<Session>,
    contestants: Vec<Contestant>,
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Scores, ScoreError> {
    let results = over_photos(&sessions, &contestants, options, None, on_photo, |job, seen| {
        Ok(seen.map(|(observation, place)| scored(job, &contestants, observation, place)))
    })?;
    let runtime = runtime(&contestants)?.map(Runtime::provenance);
    Scores::new(sessions, contestants, results, runtime)
}

/// What the results depend on besides the photos, the detectors and this program: versions of libraries.
pub fn libraries() -> String {
    TagDetectorChoice::default().provenance()
}

/// Looks at the photos of one shard only; [`merge`] judges them with the others.
pub fn observe(
    sessions: &[Session],
    contestants: &[Contestant],
    options: &Options,
    part: shard::Part,
    on_photo: impl Fn() + Sync,
) -> Result<shard::Observed, ScoreError> {
    over_photos(sessions, contestants, options, Some(part), on_photo, |job, seen| {
        let observation = seen
            .map(|(observation, _)| observation)
            .map_err(|left_out| left_out.reason);
        Ok((job.id, observation))
    })
}

/// Scores photos that shards have looked at; `runtime` is the ONNX Runtime they ran on.
pub fn merge(
    sessions: Vec<Session>,
    contestants: Vec<Contestant>,
    mut observed: BTreeMap<u64, Result<Observation, String>>,
    runtime: Option<String>,
) -> Result<Scores, ScoreError> {
    check_alike(&sessions)?;
    let mut judge = |job: &Job| {
        let not_observed = || ScoreError::NotObserved {
            session: job.session.name.clone(),
            file: job.entry.file.clone(),
        };
        let observation = observed.remove(&job.id).ok_or_else(not_observed)?;
        Ok(observation
            .and_then(|o| place(job, &o).map(|place| scored(job, &contestants, o, place)))
            .map_err(|reason| job.left_out(reason)))
    };
    let jobs = Job::all(&sessions);
    let results = jobs.iter().map(&mut judge).collect::<Result<_, ScoreError>>()?;
    drop(jobs);
    Scores::new(sessions, contestants, results, runtime)
}

/// Looks at every photo, or those of a part, and keeps what `judge` makes of each.
fn over_photos<R: Send>(
    sessions: &[Session],
    contestants: &[Contestant],
    options: &Options,
    part: Option<shard::Part>,
    on_photo: impl Fn() + Sync,
    judge: impl Fn(&Job, Result<(Observation, Place), NotScored>) -> Result<R, ScoreError> + Sync,
) -> Result<Vec<R>, ScoreError> {
    check_alike(sessions)?;
    let runtime = runtime(contestants)?;
    let families = sessions.iter().flat_map(|s| s.scene.families());
    let families: Vec<_> = families
        .collect::<std::collections::BTreeSet<_>>()
        .into_iter()
        .collect();
    let mut jobs = Job::all(sessions);
    let photos = jobs.len();
    jobs.retain(|job| part.is_none_or(|part| part.holds(job.id)));
    workers::map_over(
        options.threads,
        &jobs,
        || Observer::new(&families, contestants, runtime, options.cache.as_ref(), photos),
        |observer, job| judge(job, observer.photo(job)?),
        on_photo,
    )
}

/// The ONNX Runtime, when some contestant runs.
pub fn runtime(contestants: &[Contestant]) -> Result<Option<&'static Runtime>, DetectError> {
    let is_needed = contestants.iter().any(|c| !c.is_recorded());
    is_needed.then(Runtime::load).transpose()
}

impl Scores {
    /// Puts the figures together.
    fn new(
        sessions: Vec<Session>,
        contestants: Vec<Contestant>,
        results: Vec<Result<ScoredPhoto, NotScored>>,
        runtime: Option<String>,
    ) -> Result<Scores, ScoreError> {
        let (mut photos, mut not_scored) = (Vec::new(), Vec::new());
        for result in results {
            match result {
                Ok(photo) => photos.push(photo),
                Err(reason) => not_scored.push(reason),
            }
        }
        if let (true, Some(first)) = (photos.is_empty(), not_scored.first()) {
            let (file, reason) = (first.file.clone(), first.reason.clone());
            return Err(ScoreError::NothingScored {
                photos: not_scored.len(),
                file,
                reason,
            });
        }
        let criteria = Criteria::default();
        Ok(Scores {
            cautions: caution::cautions(&photos, &not_scored, &sessions, &contestants),
            summaries: summary::summaries(&photos, &contestants, &sessions[0].scene.bins, criteria.ap),
            criteria,
            runtime,
            sessions,
            contestants,
            photos,
            not_scored,
        })
    }
}

fn check_alike(sessions: &[Session]) -> Result<(), ScoreError> {
    let first = sessions.first().ok_or(ScoreError::NoSession)?;
    let places: Vec<_> = sessions
        .iter()
        .map(|s| s.folder.canonicalize().unwrap_or_else(|_| s.folder.clone()))
        .collect();
    if let Some(i) = (1..places.len()).find(|i| places[..*i].contains(&places[*i])) {
        return Err(ScoreError::SessionTwice {
            folder: sessions[i].folder.display().to_string(),
        });
    }
    let alike = |s: &&Session| s.scene.bins == first.scene.bins && s.scene.model.class == first.scene.model.class;
    match sessions.iter().find(|s| !alike(s)) {
        None => Ok(()),
        Some(other) => {
            let name = |s: &Session| s.folder.display().to_string();
            Err(ScoreError::DifferentScenes {
                a: name(first),
                b: name(other),
            })
        }
    }
}

/// The per-photo values of a photo whose model was placed.
fn scored(job: &Job, contestants: &[Contestant], observation: Observation, place: Place) -> ScoredPhoto {
    let outcomes = contestants
        .iter()
        .zip(&observation.detections)
        .map(|(c, found)| Outcome::of(found, &place.truth, &c.counted, HIT_CONFIDENCE))
        .collect();
    let viewpoint = job.entry.viewpoint.or(place.located.as_ref().map(|l| l.viewpoint));
    ScoredPhoto {
        id: job.id,
        session: job.session_index,
        file: job.entry.file.clone(),
        sha256: observation.sha256,
        variant: job.entry.variant.clone(),
        place: job.entry.place.clone(),
        width: observation.width,
        height: observation.height,
        viewpoint,
        bin: viewpoint.map(|v| job.session.scene.bins.bin_of(&v)),
        tags: place.located.as_ref().map(|l| l.tags.clone()).unwrap_or_default(),
        tag_marks: marks(&observation.tags, place.located.as_ref()),
        rms_px: place.located.as_ref().map(|l| l.rms_px),
        truth: place.truth,
        truth_given: job.entry.box_xyxy_px.is_some(),
        detections: observation.detections,
        outcomes,
        preview_jpeg: observation.preview_jpeg,
    }
}

/// Where the tags were seen, by id, and which of them the pose rests on.
fn marks(seen: &[SeenTag], located: Option<&Located>) -> Vec<TagMark> {
    let mut marks: Vec<TagMark> = seen
        .iter()
        .map(|tag| TagMark {
            id: tag.id,
            corners_px: tag.corners_px,
            is_used: located.is_some_and(|l| l.tags.contains(&tag.id)),
        })
        .collect();
    marks.sort_by_key(|mark| mark.id);
    marks
}
