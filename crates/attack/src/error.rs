//! The error of attacks, baselines and evaluations.

use std::path::PathBuf;

use scaleproof_core::files::FileError;
use scaleproof_core::message::{Message, message};
use scaleproof_frames::FramesError;
use scaleproof_session::SessionError;
use scaleproof_surface::pattern::PatternError;

/// Error of an attack, a baseline or an evaluation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AttackError {
    #[error(transparent)]
    Frames(#[from] FramesError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Message(#[from] Message),
    #[error("the paint is seen in none of the views: point the camera at the model")]
    NothingSeen,
    #[error(
        "the loss of {detector} on the view of {view} is not a number (step {step}): the weights are damaged, or the frame is; nothing was moved, and \
         what was reached is kept"
    )]
    NotANumber { detector: String, view: String, step: u32 },
    #[error(
        "{path} is the checkpoint of a run with other settings, frames, detectors or classes{which}: give another folder, or remove it"
    )]
    OtherRun { path: PathBuf, which: String },
    #[error("{path} is damaged: remove it, and the run starts over")]
    Damaged { path: PathBuf },
}

impl From<serde_json::Error> for AttackError {
    fn from(e: serde_json::Error) -> Self {
        message!("the run could not be saved ({e})").into()
    }
}

impl From<postcard::Error> for AttackError {
    fn from(e: postcard::Error) -> Self {
        message!("the run could not be saved ({e})").into()
    }
}
