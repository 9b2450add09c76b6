//! Where frames come from, behind one trait.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use image::RgbImage;

use super::live::{CameraSettings, LiveCameraError};
use super::stream::StreamAddress;
use scaleproof_core::files::FileError;
use scaleproof_session::SessionError;

/// One image of a source.
#[derive(Debug, Clone)]
pub struct SourceFrame {
    /// What the source calls it: for people, never a path that is written to.
    pub name: String,
    /// When it was taken, RFC 3339, where the source knows.
    pub taken: Option<String>,
    pub original: Original,
}

/// What a source has of a frame.
#[derive(Debug, Clone)]
pub enum Original {
    /// A JPEG or PNG file; it is kept byte for byte.
    Encoded(Vec<u8>),
    /// The pixels of a camera that gives no file; kept as PNG that lies as the sensor does.
    Pixels(RgbImage),
    /// None: the sentence says why.
    Unreadable(String),
}

impl SourceFrame {
    /// A frame whose source does not know when it was taken.
    pub fn untimed(name: String, original: Original) -> SourceFrame {
        SourceFrame {
            name,
            taken: None,
            original,
        }
    }
}

impl Original {
    /// Of a file that was read, or that cannot be.
    pub fn from_file(read: Result<Vec<u8>, impl ToString>) -> Original {
        read.map_or_else(|e| Original::Unreadable(e.to_string()), Original::Encoded)
    }
}

/// Anything that gives frames.
pub trait FrameSource {
    /// The next frame, waited for; `None` when there will be no more.
    ///
    /// # Errors
    /// The source itself is gone; a single bad frame is an [`Original::Unreadable`].
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError>;

    /// Whether a frame follows the last one so closely that their difference tells whether the camera moves. Otherwise each is a photo
    /// that somebody took on purpose.
    fn is_stream(&self) -> bool {
        false
    }

    /// What a camera was set to; `None` for sources that are none, and while it still settles.
    fn settings(&self) -> Option<CameraSettings> {
        None
    }
}

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

/// A source as it is named on the command line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SourceName {
    /// `replay:DIR`: the photos of a session.
    Replay(PathBuf),
    /// `watch:DIR`: photos that arrive in a folder.
    Watch(PathBuf),
    /// `camera:N`, or `camera` for the first.
    Camera(u32),
    /// `http://…` or `rtsp://…`: a camera that streams.
    Stream(StreamAddress),
    /// `upload`: only what browsers send to the page.
    Upload,
}

impl FromStr for SourceName {
    type Err = SourceError;

    fn from_str(text: &str) -> Result<SourceName, SourceError> {
        let unknown = || SourceError::Unknown { text: text.to_owned() };
        // Any address is a stream's, so that one that is not read is refused without its password.
        if StreamAddress::looks_like(text) {
            return Ok(SourceName::Stream(StreamAddress::new(text)));
        }
        match text.split_once(':') {
            Some(("replay", folder)) if !folder.is_empty() => Ok(SourceName::Replay(folder.into())),
            Some(("watch", folder)) if !folder.is_empty() => Ok(SourceName::Watch(folder.into())),
            Some(("camera", number)) => number.parse().map(SourceName::Camera).map_err(|_| unknown()),
            None if text == "camera" => Ok(SourceName::Camera(0)),
            None if text == "upload" => Ok(SourceName::Upload),
            _ => Err(unknown()),
        }
    }
}

impl SourceName {
    /// The folder it reads, if it reads one.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            SourceName::Replay(folder) | SourceName::Watch(folder) => Some(folder),
            _ => None,
        }
    }

    /// Its kind, in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            SourceName::Replay(_) => "replay",
            SourceName::Watch(_) => "watched folder",
            SourceName::Camera(_) => "camera",
            SourceName::Stream(_) => "stream",
            SourceName::Upload => "upload",
        }
    }
}
