//! Reasons why a source of frames ends.

use std::path::PathBuf;

use super::live::LiveCameraError;
use scaleproof_core::files::FileError;
use scaleproof_session::SessionError;

/// Why a source gives no (more) frames.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    #[error(
        "the source '{text}' is not known: use camera or camera:N, http://… or rtsp://… for one that streams, watch:DIR for a folder that photos arrive in, replay:DIR for a stored session, or upload for what browsers send to the page"
    )]
    Unknown { text: String },
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("the session in {folder} has no photo of the variant {variant}, only of {others}: replay another, or name one of these", folder = folder.display())]
    NoSuchVariant {
        folder: PathBuf,
        variant: String,
        others: String,
    },
    #[error(
        "the watched folder {folder} cannot be read ({reason}): bring it back and run this again; what was accepted is kept", folder = folder.display()
    )]
    Gone { folder: PathBuf, reason: String },
    #[error("the camera {number} cannot be used ({reason}): see `scaleproof capture list-cameras`")]
    NoCamera { number: u32, reason: LiveCameraError },
    #[error(
        "the camera {number} gives no more images ({reason}): plug it in again and run this again; what was accepted is kept"
    )]
    CameraGone { number: u32, reason: LiveCameraError },
    #[error("the stream {address} is not read: {reason}")]
    BadAddress { address: String, reason: &'static str },
    #[error(
        "the stream {address} cannot be used ({reason}): see that the camera serves it and that a browser or player shows it"
    )]
    NoStream { address: String, reason: LiveCameraError },
    #[error(
        "the stream {address} gives no more images ({reason}): see to the camera and run this again; what was accepted is kept"
    )]
    StreamGone { address: String, reason: LiveCameraError },
}
