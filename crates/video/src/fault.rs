//! Reasons why a video gave no (more) frames.

use scaleproof_core::files::FileError;
use scaleproof_core::message::{Message, message};

/// Reason why a video gave no (more) frames. `name` is the input's: a file's path, or a stream's address.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Message(#[from] Message),
    #[error(
        "{name} is no video that is read here ({reason}): use the MP4, MOV, MKV or WebM file of the camera, and copy it again if it is one"
    )]
    NotAVideo { name: String, reason: String },
    #[error("{name} has sound and no picture: use the file that the camera wrote as a video")]
    NoPicture { name: String },
    #[error("{name} has no frame that can be shown: copy it from the camera again")]
    NoFrames { name: String },
    #[error("{name} is damaged or cut after {after_s:.2} s ({reason}): copy it from the camera again")]
    Damaged {
        name: String,
        /// Time of the last whole frame, s.
        after_s: f64,
        reason: String,
    },
    #[error("{name} gave no frame for {waited_s:.0} s")]
    Silent { name: String, waited_s: f64 },
}

impl VideoError {
    pub(crate) fn encrypted(name: &str) -> VideoError {
        message!("{name} is encrypted: use a copy without protection").into()
    }

    pub(crate) fn not_started(name: &str, program: &str, reason: &str) -> VideoError {
        message!("{program} could not be started for {name}: {reason}").into()
    }
}
