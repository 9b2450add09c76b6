//! Times of the stages of the work on each photo.

use crate::error::ScoreError;
use crate::evaluated::{EvaluatedDetector, runtime};
use crate::figures::nothing_scored;
use crate::observe::{Observer, ScoringJob};
use scaleproof_core::workers::stopwatch::{self, Stage, StageMs};
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::{PhotoEntry, Session};

/// A photo of which the pose is known, and the time that each stage of the work took.
pub struct TimedPhoto {
    /// The photo with its box and viewpoint, as a session has it that says where the model is.
    pub with_truth: PhotoEntry,
    pub ms: StageMs,
}

/// Times every photo on one thread without a cache, in `rounds` rounds after one that does not count. Photos that are left out are in no round.
pub fn timed_photos(
    session: &Session,
    detectors: &[EvaluatedDetector],
    rounds: usize,
    on_photo: impl Fn() + Sync,
) -> Result<Vec<Vec<TimedPhoto>>, ScoreError> {
    let sessions = std::slice::from_ref(session);
    let jobs = ScoringJob::all(sessions);
    let families = session.scene.families().into_iter().collect::<Vec<_>>();
    let (tags, runtime) = (TagDetectorChoice::default(), runtime(detectors)?);
    let mut observer = Observer::new(&families, tags, detectors, runtime, None, jobs.len())?;
    let mut timed = Vec::new();
    for round in 0..=rounds {
        let (mut photos, mut left_out) = (Vec::new(), None);
        for job in &jobs {
            stopwatch::take();
            let seen = stopwatch::timed(Stage::Rest, || observer.photo(job))?;
            match seen {
                Ok((_, place)) => {
                    let seen = place.located.map(|located| located.viewpoint);
                    let with_truth = PhotoEntry {
                        box_xyxy_px: Some(place.truth),
                        viewpoint: job.entry.viewpoint.or(seen),
                        ..job.entry.clone()
                    };
                    let ms = stopwatch::take();
                    photos.push(TimedPhoto { with_truth, ms });
                }
                Err(reason) => left_out = left_out.or(Some(reason)),
            }
            on_photo();
        }
        if photos.is_empty() {
            nothing_scored(jobs.len(), left_out.as_ref())?;
        }
        if round > 0 {
            timed.push(photos);
        }
    }
    Ok(timed)
}
