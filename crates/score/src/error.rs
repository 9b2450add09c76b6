//! Error of a run that could not finish.

use scaleproof_detect::{DetectError, OutsideError, ProgramError};
use scaleproof_photo::PhotoError;
use scaleproof_pose::tags::StartError;

/// Reason why a run could not finish. Bad photos are none: they are listed in `Scores::not_scored`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    #[error("the run was stopped")]
    Stopped,
    #[error("no session to score")]
    NoSession,
    #[error("{a} and {b} have different bins or model classes: score them in separate runs")]
    DifferentScenes { a: String, b: String },
    #[error("the session {folder} is named twice: each photo counts once")]
    SessionTwice { folder: String },
    #[error("{file} has no recorded detections of {detector}")]
    NotRecorded { file: String, detector: String },
    #[error("{}", none_of(*photos, file, reason))]
    NothingScored {
        photos: usize,
        file: String,
        reason: String,
    },
    #[error("the shards do not hold {file} of {session}: score them again")]
    NotObserved { session: String, file: String },
    #[error(
        "{detector} cannot look at photos that are {changed}: stored detections and those of other programs are of the photos as they are, and programs must take pixels (\"input\": \"rgb\")"
    )]
    NotCorruptible {
        detector: String,
        /// Kind of change, as in "made worse".
        changed: &'static str,
    },
    #[error("all photos have the variant `{variant}`: there is no drop to follow on photos that are {changed}")]
    OneVariant { variant: String, changed: &'static str },
    #[error("{file} is another photo than it was at the beginning of this run: run it again")]
    PhotoChanged { file: String },
    #[error("{file} cannot be changed by {by}: it cannot be encoded")]
    NotChanged { file: String, by: String },
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Outside(#[from] OutsideError),
    #[error(transparent)]
    Program(#[from] ProgramError),
    #[error(transparent)]
    Detect(#[from] DetectError),
    #[error(transparent)]
    Tags(#[from] StartError),
}

fn none_of(photos: usize, file: &str, reason: &str) -> String {
    match photos {
        1 => format!("the only photo, {file}, could not be scored: {reason}"),
        _ => format!("none of the {photos} photos could be scored; {file}, for one: {reason}"),
    }
}
