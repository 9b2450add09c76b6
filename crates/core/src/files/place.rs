//! Place of an output: a file, a stream, or something that must stay as it is.

use std::fs::{FileType, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::error::{FileError, plain};

/// Place of an output.
#[derive(Debug)]
pub(super) enum OutputPlace {
    /// A regular file, or one to be made; what a symbolic link points to.
    File(PathBuf),
    /// Standard output, a named pipe or a character device: written to, and not replaced.
    Stream(PathBuf),
}

impl OutputPlace {
    pub(super) fn at(path: &Path) -> Result<OutputPlace, FileError> {
        let refused = |reason: &str| Err(FileError::cannot_write(path, reason));
        if is_standard_output(path) {
            return Ok(OutputPlace::Stream(path.to_owned()));
        }
        match (std::fs::metadata(path), path.is_symlink()) {
            (Ok(about), _) if about.is_dir() => refused("a folder is in its place"),
            (Ok(about), _) if is_stream_kind(about.file_type()) => Ok(OutputPlace::Stream(path.to_owned())),
            (Ok(about), _) if !about.is_file() => refused("what is in its place is no file: name another output"),
            (Ok(about), _) if about.permissions().readonly() => refused("it is write-protected"),
            (Ok(_), true) => match path.canonicalize() {
                Ok(target) => Ok(OutputPlace::File(target)),
                Err(e) => refused(&plain(&e)),
            },
            (Err(_), true) => refused("a symbolic link to nothing is in its place: remove it, or name another output"),
            _ if path.file_name().is_none() => refused("it is not a file name"),
            _ => Ok(OutputPlace::File(path.to_owned())),
        }
    }
}

pub fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout"].iter().any(|name| path == Path::new(name))
}

/// Returns true if an output is written to as a stream: standard output, a named pipe or a character device.
pub fn is_stream(path: &Path) -> Result<bool, FileError> {
    Ok(matches!(OutputPlace::at(path)?, OutputPlace::Stream(_)))
}

pub(super) fn write_to(stream: &Path, content: &[u8]) -> Result<(), FileError> {
    let (written, name) = if is_standard_output(stream) {
        let mut out = std::io::stdout().lock();
        let written = out.write_all(content).and_then(|()| out.flush());
        (written, Path::new("standard output"))
    } else {
        let opened = OpenOptions::new().write(true).open(stream);
        (opened.and_then(|mut device| device.write_all(content)), stream)
    };
    match written {
        // The reader has enough, as `head` does.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|e| FileError::write(name, &e)),
    }
}

#[cfg(unix)]
fn is_stream_kind(kind: FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo() || kind.is_char_device()
}

#[cfg(not(unix))]
fn is_stream_kind(_: FileType) -> bool {
    false
}
