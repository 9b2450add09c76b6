//! Detections of a run stored with its sessions, to be played back by later runs.

use crate::error::ScoreError;
use crate::evaluated::EvaluatedDetector;
use crate::figures::Scores;
use scaleproof_core::files;
use scaleproof_core::message::bail;
use scaleproof_detect::{Recorded, RecordedError, RecordedPhoto, Recording, SCORE_FLOOR};
use scaleproof_session::Session;

/// Checks before a run that its detections can be stored, and, unless `replace`, that none are stored yet.
pub fn check_recordings(
    sessions: &[Session],
    detectors: &[EvaluatedDetector],
    replace: bool,
) -> Result<(), ScoreError> {
    for session in sessions {
        let folder = EvaluatedDetector::recordings_of(&session.folder);
        let is_there = |d: &&EvaluatedDetector| Recording::is_in(&folder, &d.manifest.name);
        if let Some(stored) = detectors.iter().find(is_there).filter(|_| !replace) {
            let (session, detector) = (session.folder.display(), &stored.manifest.name);
            bail!(
                "{session} has a recording of {detector} already";
                hint: "add ‹replace› to store it anew, or play it with ‹recorded›"
            );
        }
        files::chosen::check_folder(&session.folder, &folder)?;
        files::check_writable(&folder)?;
    }
    Ok(())
}

/// Stores the detections of every scored photo in the folders of the sessions.
pub fn record(scores: &Scores) -> Result<(), RecordedError> {
    let photos = scores.all_photos();
    for (session_index, session) in scores.sessions.iter().enumerate() {
        let photos: Vec<_> = photos.iter().filter(|p| p.session == session_index).collect();
        for (index, detector) in scores.detectors.iter().enumerate() {
            let recorded = photos.iter().map(|p| RecordedPhoto {
                id: p.id,
                file: p.file.clone(),
                sha256: p.sha256.clone(),
            });
            let recording = Recording {
                detector: detector.manifest.name.clone(),
                weights_sha256: detector.manifest.weights.sha256.clone(),
                results_sha256: String::new(),
                scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
                runtime: scores.runtime.clone().unwrap_or_default(),
                score_floor: SCORE_FLOOR,
                photos: recorded.collect(),
            };
            let detections: Vec<_> = photos.iter().map(|p| p.detections[index].as_slice()).collect();
            let folder = EvaluatedDetector::recordings_of(&session.folder);
            // It was checked before the run, and may be another by now.
            files::chosen::check_folder(&session.folder, &folder)?;
            Recorded::save(&folder, &detector.manifest, recording, &detections)?;
        }
    }
    Ok(())
}
