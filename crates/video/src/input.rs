//! What ffmpeg reads: the arguments that stand before and with `-i`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use scaleproof_core::files;

/// Containers that cameras write. Playlists and scripts, which name other files, are none of them.
const CONTAINERS: &str = "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,ogg,flv,asf";

/// Where frames come from, as arguments of `ffmpeg` and `ffprobe`. Nothing passes a shell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// What messages call it.
    pub name: String,
    /// All arguments up to `-i` and what follows it. Whoever makes one says which protocols may be opened.
    pub arguments: Vec<OsString>,
    /// The file, where it is one.
    pub file: Option<PathBuf>,
}

impl Input {
    /// A file. Only this one is opened, whatever stands in it: of protocols there is only `file`, and of containers those of cameras, since
    /// a playlist could name any other file.
    pub fn file(path: &Path) -> Input {
        let mut url = OsString::from("file:");
        // With the protocol before it, a name that begins with a dash or contains a colon is a name.
        url.push(path);
        let mut arguments: Vec<OsString> = ["-protocol_whitelist", "file", "-format_whitelist", CONTAINERS, "-i"]
            .map(OsString::from)
            .into();
        arguments.push(url);
        files::inputs::note(path);
        Input {
            name: path.display().to_string(),
            arguments,
            file: Some(path.to_owned()),
        }
    }

    /// Anything else that ffmpeg reads, such as a stream.
    pub fn other(name: String, arguments: Vec<OsString>) -> Input {
        Input {
            name,
            arguments,
            file: None,
        }
    }
}
