//! Input of ffmpeg: the arguments before and with `-i`.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use scaleproof_core::files::{self, FileError};

use crate::VideoError;

/// Containers that cameras write. Playlists and scripts, which name other files, are none of them.
const CONTAINERS: &str = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,ogg,flv,asf";

/// ffmpeg takes 0.3 GB of addresses, of which most is its own code, and frames of 4K for each of its threads.
const MOST_MEMORY: u64 = 4 << 30;

/// Input as arguments of `ffmpeg` and `ffprobe`. Nothing passes a shell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Name in messages.
    pub name: String,
    /// All arguments up to `-i` and what follows it. Whoever makes one says which protocols may be opened.
    pub arguments: Vec<OsString>,
    /// The file, where it is one; ffmpeg gets it as its standard input.
    pub file: Option<PathBuf>,
    /// Memory that the programs that read it may address, bytes: what comes over a network may announce anything.
    pub most_memory: Option<u64>,
}

/// ffmpeg's name of a file, which it reads from standard input: a film's own name must not be among its messages.
#[cfg(unix)]
pub(crate) const SHOWN: &str = "/dev/stdin";
#[cfg(not(unix))]
pub(crate) const SHOWN: &str = "";

impl Input {
    /// Returns a file as input. Only this one is opened, whatever stands in it: of protocols there is only `file`, and of containers those of cameras, since
    /// a playlist could name any other file.
    pub fn file(path: &Path) -> Input {
        let mut url = OsString::from("file:");
        // With the protocol before it, a name that begins with a dash or contains a colon is a name.
        url.push(if SHOWN.is_empty() { path } else { Path::new(SHOWN) });
        let mut arguments: Vec<OsString> = ["-protocol_whitelist", "file", "-format_whitelist", CONTAINERS, "-i"]
            .map(OsString::from)
            .into();
        arguments.push(url);
        files::inputs::note(path);
        Input {
            name: path.display().to_string(),
            arguments,
            file: Some(path.to_owned()),
            most_memory: None,
        }
    }

    /// Gives a command of these arguments the file, opened anew: what reads it moves in no other's.
    pub(crate) fn feed(&self, command: &mut Command) -> Result<(), VideoError> {
        if let Some(path) = self.file.as_ref().filter(|_| !SHOWN.is_empty()) {
            command.stdin(File::open(path).map_err(|e| FileError::read(path, &e))?);
        }
        Ok(())
    }

    /// Returns anything else that ffmpeg reads as input, such as a stream.
    pub fn other(name: String, arguments: Vec<OsString>) -> Input {
        Input {
            name,
            arguments,
            file: None,
            most_memory: Some(MOST_MEMORY),
        }
    }
}
