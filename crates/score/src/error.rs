//! Error of a run that could not finish.

use scaleproof_core::files::FileError;
use scaleproof_core::message::Message;
use scaleproof_detect::{DetectError, OutsideError, ProgramError};
use scaleproof_photo::PhotoError;
use scaleproof_pose::tags::StartError;

/// Reason why a run could not finish. Bad photos are none: they are listed in `Scores::not_scored`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScoreError {
    #[error("{}", none_of(*photos, file, reason))]
    NothingScored {
        photos: usize,
        file: String,
        reason: String,
    },
    #[error(transparent)]
    File(#[from] FileError),
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
    #[error(transparent)]
    Message(#[from] Message),
}

fn none_of(photos: usize, file: &str, reason: &str) -> String {
    match photos {
        1 => format!("the only photo, {file}, could not be scored: {reason}"),
        _ => format!("none of the {photos} photos could be scored; {file}, for one: {reason}"),
    }
}
