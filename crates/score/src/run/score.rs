//! A scoring run: every photo of some sessions through pose, truth and detectors, in parallel.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::Ordering;

use crate::error::ScoreError;
use crate::evaluated::{EvaluatedDetector, runtime};
use crate::figures::{Criteria, NotScored, PhotoOutcome, ScoredPhoto, Scores, TagMark};
use crate::observe::{NotScoredReason, Observation, Observer, Options, PlacedModel, ScoringJob, place};
use crate::run::contradicted;
use crate::run::contradicted::JudgedPhoto;
use crate::run::shard::{ShardId, ShardObservations};
use scaleproof_core::message::{bail, message};
use scaleproof_core::workers;
use scaleproof_detect::Runtime;
use scaleproof_pose::locate::Located;
use scaleproof_pose::tags::SeenTag;
use scaleproof_session::Session;

/// Scores every photo of the sessions with every detector, by the default criteria. `on_photo` is called after each photo.
pub fn score(
    sessions: Vec<Session>,
    detectors: Vec<EvaluatedDetector>,
    options: &Options,
    on_photo: impl Fn() + Sync,
) -> Result<Scores, ScoreError> {
    let mut jobs = ScoringJob::all(&sessions);
    contradicted::draw(&mut jobs);
    let mut judged = over_photos(&sessions, &jobs, &detectors, options, on_photo, |observer, job| {
        Ok(judge(job, &detectors, observer.photo(job)?))
    })?;
    let open = contradicted::left_open(&jobs, &judged);
    let looked = over_photos(
        &sessions,
        &open,
        &detectors,
        options,
        || {},
        |observer, at| {
            let seen = observer.tags_alone(&jobs[*at])?;
            Ok(seen
                .ok()
                .and_then(|seen| contradicted::contradiction(&jobs[*at], &seen)))
        },
    )?;
    for (at, contradiction) in open.into_iter().zip(looked) {
        judged[at].contradiction = contradiction;
    }
    let results = contradicted::refused(&jobs, judged);
    drop(jobs);
    let runtime = runtime(&detectors)?.map(Runtime::provenance);
    let mut scores = Scores::new(sessions, detectors, results, runtime)?;
    scores.tags = options.tags;
    Ok(scores)
}

/// Observes the photos of one shard only; [`merge`] judges them with the others. Contradictions that the others find are not known here: the tags of
/// all photos are searched.
pub fn observe(
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    options: &Options,
    shard: ShardId,
    on_photo: impl Fn() + Sync,
) -> Result<ShardObservations, ScoreError> {
    let mut jobs = ScoringJob::all(sessions);
    jobs.retain(|job| shard.holds(job.id));
    jobs.iter_mut()
        .for_each(|job| job.is_checked = contradicted::is_checkable(job));
    over_photos(sessions, &jobs, detectors, options, on_photo, |observer, job| {
        let observation = observer
            .photo(job)?
            .map(|(observation, _)| observation)
            .map_err(|left_out| NotScoredReason(left_out.reason));
        Ok((job.id, observation))
    })
}

/// Scores photos that shards have observed; `runtime` is the ONNX Runtime they ran on.
pub fn merge(
    sessions: Vec<Session>,
    detectors: Vec<EvaluatedDetector>,
    mut observed: BTreeMap<u64, Result<Observation, NotScoredReason>>,
    runtime: Option<String>,
) -> Result<Scores, ScoreError> {
    check_alike(&sessions)?;
    let mut observed_in_shard = |job: &ScoringJob| {
        let not_observed = || {
            let (session, file) = (&job.session.name, &job.entry.file);
            message!("the shards do not hold {file} of {session}: score them again")
        };
        let observation = observed.remove(&job.id).ok_or_else(not_observed)?;
        let seen = observation.and_then(|o| place(job, &o).map(|place| (o, place)));
        Ok(judge(job, &detectors, seen.map_err(|reason| job.left_out(reason))))
    };
    let mut jobs = ScoringJob::all(&sessions);
    contradicted::draw(&mut jobs);
    let judged = jobs
        .iter()
        .map(&mut observed_in_shard)
        .collect::<Result<_, ScoreError>>()?;
    let results = contradicted::refused(&jobs, judged);
    drop(jobs);
    Scores::new(sessions, detectors, results, runtime)
}

/// Calls `work` on every item, a photo of the sessions, in parallel, with an observer for each thread.
fn over_photos<T: Sync, R: Send>(
    sessions: &[Session],
    items: &[T],
    detectors: &[EvaluatedDetector],
    options: &Options,
    on_photo: impl Fn() + Sync,
    work: impl Fn(&mut Observer, &T) -> Result<R, ScoreError> + Sync,
) -> Result<Vec<R>, ScoreError> {
    check_alike(sessions)?;
    let runtime = runtime(detectors)?;
    let families = sessions.iter().flat_map(|s| s.scene.families());
    let families: Vec<_> = families.collect::<BTreeSet<_>>().into_iter().collect();
    let photos = sessions.iter().map(|s| s.photos.len()).sum();
    let cache = options.cache.as_ref();
    workers::map_over(
        options.threads,
        items,
        || Observer::new(&families, options.tags, detectors, runtime, cache, photos),
        |observer, item| {
            if options.stop.load(Ordering::Relaxed) {
                bail!("the run was stopped");
            }
            work(observer, item)
        },
        on_photo,
    )
}

fn check_alike(sessions: &[Session]) -> Result<(), ScoreError> {
    let first = sessions.first().ok_or_else(|| message!("no session to score"))?;
    let real = |s: &Session| s.folder.canonicalize().unwrap_or_else(|_| s.folder.clone());
    let places: Vec<_> = sessions.iter().map(real).collect();
    let name = |s: &Session| s.folder.display().to_string();
    if let Some(i) = (1..places.len()).find(|i| places[..*i].contains(&places[*i])) {
        bail!(
            "the session {} is named twice: each photo counts once",
            name(&sessions[i])
        );
    }
    let alike = |s: &&Session| s.scene.bins == first.scene.bins && s.scene.model.class == first.scene.model.class;
    let Some(other) = sessions.iter().find(|s| !alike(s)) else {
        return Ok(());
    };
    let (a, b) = (name(first), name(other));
    bail!("{a} and {b} have different bins or model classes: score them in separate runs")
}

/// Returns the result of observing a photo.
fn judge(
    job: &ScoringJob,
    detectors: &[EvaluatedDetector],
    seen: Result<(Observation, PlacedModel), NotScored>,
) -> JudgedPhoto {
    let looked = seen.as_ref().ok();
    JudgedPhoto {
        contradiction: looked.and_then(|(observation, _)| contradicted::contradiction(job, observation)),
        photo: seen.map(|(observation, place)| scored(job, detectors, observation, place)),
    }
}

/// Returns the values of a photo whose model was placed.
fn scored(
    job: &ScoringJob,
    detectors: &[EvaluatedDetector],
    observation: Observation,
    place: PlacedModel,
) -> ScoredPhoto {
    let (entry, located) = (job.entry, place.located.as_ref());
    let least = Criteria::default().thresholds();
    let outcomes = PhotoOutcome::of_each(detectors, &observation.detections, &place.truth, least);
    let viewpoint = entry.viewpoint.or(located.map(|l| l.viewpoint));
    ScoredPhoto {
        id: job.id,
        session: job.session_index,
        file: entry.file.clone(),
        sha256: observation.sha256,
        variant: entry.variant.clone(),
        place: entry.place.clone(),
        conditions: entry.conditions.clone(),
        width: observation.width,
        height: observation.height,
        viewpoint,
        bin: viewpoint.map(|v| job.session.scene.bins.bin_of(&v)),
        tags: located.map(|l| l.tags.clone()).unwrap_or_default(),
        tag_marks: if job.needs_tags() {
            marks(&observation.tags, located)
        } else {
            Vec::new()
        },
        rms_px: located.map(|l| l.rms_px),
        sigma: located.map(|l| l.sigma),
        taken: entry.taken.clone().or(observation.taken),
        exposure: observation.exposure,
        truth: place.truth,
        truth_given: entry.box_xyxy_px.is_some(),
        detections: observation.detections,
        outcomes,
        preview_jpeg: observation.preview_jpeg,
        hash: observation.hash,
        near_copies: 0,
        repeat_of: None,
    }
}

/// Returns the corners of the tags, by id, and which of them the pose rests on.
fn marks(seen: &[SeenTag], located: Option<&Located>) -> Vec<TagMark> {
    let mark = |tag: &SeenTag| TagMark {
        id: tag.id,
        corners_px: tag.corners_px,
        is_used: located.is_some_and(|l| l.tags.contains(&tag.id)),
    };
    let mut marks: Vec<TagMark> = seen.iter().map(mark).collect();
    marks.sort_by_key(|mark| mark.id);
    marks
}
