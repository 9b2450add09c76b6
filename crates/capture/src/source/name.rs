//! Names of sources, as users give them.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::stream::StreamAddress;
use scaleproof_core::message::{Message, message};

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
    type Err = Message;

    fn from_str(text: &str) -> Result<SourceName, Message> {
        let unknown = || {
            message!(
                "the source '{text}' is not known: use camera or camera:N, http://… or rtsp://… for one that streams, watch:DIR for a folder \
                 that photos arrive in, replay:DIR for a stored session, or upload for what browsers send to the page"
            )
        };
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
    /// Returns the folder it reads, if it reads one.
    pub fn folder(&self) -> Option<&Path> {
        match self {
            SourceName::Replay(folder) | SourceName::Watch(folder) => Some(folder),
            _ => None,
        }
    }

    /// Returns its kind, in a word.
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
