//! A scoring run: every photo of some sessions through pose, truth and detectors, in parallel.

use super::{
    Contestant, Criteria, HIT_CONFIDENCE, NotScored, Outcome, ScoredPhoto, Source, Summary, TagMark, caution, preview,
    summary,
};
use crate::detect::{DetectError, Detection, Detector, Runtime};
use crate::geometry::BoxPx;
use crate::locate::{self, Abstention, Located};
use crate::photo::Photo;
use crate::session::{PhotoEntry, Session};
use crate::tags::{SeenTag, StartError, TagDetector, TagDetectorChoice};
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
    #[error(
        "{file} has no recorded detections of {detector}: run without --recorded, or record them again with --record"
    )]
    NotRecorded { file: String, detector: String },
    #[error("none of the {photos} photos could be scored; {file}, for one: {reason}")]
    NothingScored {
        photos: usize,
        file: String,
        reason: String,
    },
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
    on_photo: impl Fn() + Sync,
) -> Result<Scores, ScoreError> {
    check_alike(&sessions)?;
    let runtime = match contestants.iter().any(|c| !c.is_recorded()) {
        true => Some(Runtime::load()?),
        false => None,
    };
    let families = sessions
        .iter()
        .flat_map(|s| s.scene.families())
        .collect::<std::collections::BTreeSet<_>>();
    let families: Vec<_> = families.into_iter().collect();
    let jobs: Vec<Job> = jobs(&sessions);
    let results = workers::map(
        &jobs,
        || {
            Ok::<_, ScoreError>(Worker {
                tags: TagDetectorChoice::default().open(&families)?,
                detectors: open(&contestants, runtime)?,
                preview_px: preview::longest_side_px(jobs.len()),
            })
        },
        |worker, job| worker.photo(job, &contestants),
        on_photo,
    )?;
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
    let cautions = caution::cautions(&photos, &not_scored, &sessions);
    let criteria = Criteria::default();
    let summaries = summary::summaries(&photos, &contestants, &sessions[0].scene.bins, criteria.ap);
    let runtime = runtime.map(Runtime::provenance);
    Ok(Scores {
        sessions,
        contestants,
        photos,
        not_scored,
        summaries,
        criteria,
        cautions,
        runtime,
    })
}

/// One photo to be scored.
struct Job<'a> {
    id: u64,
    session_index: usize,
    session: &'a Session,
    entry: &'a PhotoEntry,
}

fn jobs(sessions: &[Session]) -> Vec<Job<'_>> {
    let entries = sessions
        .iter()
        .enumerate()
        .flat_map(|(i, s)| s.photos.iter().map(move |entry| (i, s, entry)));
    (1..)
        .zip(entries)
        .map(|(id, (session_index, session, entry))| Job {
            id,
            session_index,
            session,
            entry,
        })
        .collect()
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

/// A detector for each live contestant, in their order.
fn open(contestants: &[Contestant], runtime: Option<&Runtime>) -> Result<Vec<Option<Detector>>, DetectError> {
    contestants
        .iter()
        .map(|c| match (&c.source, runtime) {
            (Source::Live(weights), Some(runtime)) => Detector::open(runtime, &c.manifest, weights).map(Some),
            _ => Ok(None),
        })
        .collect()
}

/// What each thread owns.
struct Worker {
    tags: Box<dyn TagDetector>,
    detectors: Vec<Option<Detector>>,
    /// Longest side of the report's pictures.
    preview_px: u32,
}

/// Where the model is in a photo, and from where it was seen.
struct Place {
    located: Option<Located>,
    /// Every tag seen.
    tag_marks: Vec<TagMark>,
    truth: BoxPx,
}

impl Worker {
    /// The outer error ends the run, the inner one only leaves the photo out.
    fn photo(&mut self, job: &Job, contestants: &[Contestant]) -> Result<Result<ScoredPhoto, NotScored>, ScoreError> {
        let left_out = |reason: String| {
            Ok(Err(NotScored {
                session: job.session.name.clone(),
                file: job.entry.file.clone(),
                variant: job.entry.variant.clone(),
                reason,
            }))
        };
        let photo = match Photo::open(&job.session.photo_path(job.entry)) {
            Ok(photo) => photo,
            Err(e) => return left_out(e.to_string()),
        };
        match self.place(&photo, job) {
            Ok(place) => match self.scored(job, &photo, place, contestants) {
                Err(ScoreError::Detect(e @ DetectError::NotANumber { .. })) => left_out(e.to_string()),
                scored => scored.map(Ok),
            },
            Err(reason) => left_out(reason),
        }
    }

    /// The session's own truth and viewpoint where it has them, else from the tags.
    fn place(&mut self, photo: &Photo, job: &Job) -> Result<Place, String> {
        let scene = &job.session.scene;
        let given = job
            .entry
            .box_xyxy_px
            .map(|b| b.clipped(photo.width().into(), photo.height().into()));
        if given.is_some_and(|b| !b.is_solid()) {
            return Err("box_xyxy_px lies outside the picture: is it another photo's?".into());
        }
        if let (Some(truth), Some(_)) = (given, job.entry.viewpoint) {
            return Ok(Place {
                located: None,
                tag_marks: Vec::new(),
                truth,
            });
        }
        let camera = job.session.known_camera().map_err(|e| e.to_string())?;
        let fitted = camera.for_photo(photo.width(), photo.height(), photo.turned_deg);
        let mut seen = Vec::new();
        let located = fitted.map_err(Abstention::from).and_then(|fitted| {
            seen = self.tags.find(&photo.grey());
            let located = locate::locate(&seen, scene, &fitted.camera)?;
            Ok((located, fitted.camera))
        });
        let tag_marks = marks(&seen, located.as_ref().ok().map(|(located, _)| located));
        match (located, given) {
            (located, Some(truth)) => Ok(Place {
                located: located.ok().map(|(located, _)| located),
                tag_marks,
                truth,
            }),
            (Ok((located, camera)), None) => {
                let outline = &job.session.outline;
                let truth = outline
                    .box_in_photo(&located.pose, &camera)
                    .map_err(|e| e.to_string())?;
                Ok(Place {
                    located: Some(located),
                    tag_marks,
                    truth,
                })
            }
            (Err(abstention), None) => Err(abstention.to_string()),
        }
    }

    fn scored(
        &mut self,
        job: &Job,
        photo: &Photo,
        place: Place,
        contestants: &[Contestant],
    ) -> Result<ScoredPhoto, ScoreError> {
        let detections = contestants
            .iter()
            .zip(&mut self.detectors)
            .map(|(contestant, detector)| detections(contestant, detector.as_mut(), photo, job))
            .collect::<Result<Vec<_>, _>>()?;
        let outcomes = contestants
            .iter()
            .zip(&detections)
            .map(|(c, found)| Outcome::of(found, &place.truth, c.class, HIT_CONFIDENCE))
            .collect();
        let viewpoint = job.entry.viewpoint.or(place.located.as_ref().map(|l| l.viewpoint));
        Ok(ScoredPhoto {
            id: job.id,
            session: job.session_index,
            file: job.entry.file.clone(),
            sha256: photo.sha256.clone(),
            variant: job.entry.variant.clone(),
            place: job.entry.place.clone(),
            width: photo.width(),
            height: photo.height(),
            viewpoint,
            bin: viewpoint.map(|v| job.session.scene.bins.bin_of(&v)),
            tags: place.located.as_ref().map(|l| l.tags.clone()).unwrap_or_default(),
            tag_marks: place.tag_marks,
            rms_px: place.located.as_ref().map(|l| l.rms_px),
            truth: place.truth,
            truth_given: job.entry.box_xyxy_px.is_some(),
            detections,
            outcomes,
            preview_jpeg: preview::jpeg(photo, self.preview_px),
        })
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

fn detections(
    contestant: &Contestant,
    detector: Option<&mut Detector>,
    photo: &Photo,
    job: &Job,
) -> Result<Vec<Detection>, ScoreError> {
    if let Some(detector) = detector {
        return Ok(detector.detect(&photo.rgb)?);
    }
    let recordings = match &contestant.source {
        Source::Recorded(recordings) => recordings.as_slice(),
        Source::Live(_) => &[],
    };
    let found = recordings
        .iter()
        .find_map(|r| r.of_photo(&photo.sha256))
        .ok_or_else(|| ScoreError::NotRecorded {
            file: job.entry.file.clone(),
            detector: contestant.manifest.name.clone(),
        })?;
    Ok(found.to_vec())
}
