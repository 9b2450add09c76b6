//! The error of frames, their makers and surrogate renderers.

use std::path::Path;

use scaleproof_core::files::FileError;
use scaleproof_core::message::{Hint, Message, message};
use scaleproof_photo::PhotoError;
use scaleproof_pose::tags::StartError;
use scaleproof_session::SessionError;
use scaleproof_session::envelope::EnvelopeError;
use scaleproof_surface::pattern::PatternError;

/// Error of frames, their makers and surrogate renderers.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FramesError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Pattern(#[from] PatternError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Mesh(#[from] EnvelopeError),
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Message(#[from] Message),
    #[error(
        "training broke down at step {step}: the loss is no number any more; what was saved before stands. Look at the frames with attack check, or \
         train again with another seed"
    )]
    NotFinite {
        step: u64,
        #[source]
        hint: Hint,
    },
}

impl FramesError {
    /// Creates the error of an encoder.
    pub(crate) fn encode(reason: impl std::fmt::Display) -> Self {
        message!("a frame could not be written ({reason})").into()
    }
}

/// Adds the file that a sentence is about.
pub(crate) fn of_file(path: &Path) -> impl Fn(Message) -> FramesError {
    move |reason| FileError::content(path, reason.to_string()).into()
}
