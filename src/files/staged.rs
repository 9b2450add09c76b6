//! A whole file under a temporary name beside its place.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::{FileError, plain};

/// Removed unless it takes its place. Its lock says that its program still runs.
pub(super) struct Staged {
    temporary: PathBuf,
    path: PathBuf,
    lock: Option<File>,
}

impl Staged {
    pub(super) fn write(path: &Path, content: &[u8]) -> Result<Staged, FileError> {
        let refused = |reason: String| FileError::Write {
            path: path.to_owned(),
            reason,
        };
        let failed = |e: std::io::Error| refused(plain(&e));
        if path.is_dir() {
            return Err(refused("a folder is in its place".into()));
        }
        let Some(name) = path.file_name() else {
            return Err(refused("it is not a file name".into()));
        };
        std::fs::create_dir_all(super::folder_of(path)).map_err(failed)?;
        let temporary = path.with_file_name(temporary_name(&name.to_string_lossy()));
        // A number of a process that crashed is used again some day; a link that somebody laid there is not followed.
        let _ = std::fs::remove_file(&temporary);
        let mut file = File::create_new(&temporary).map_err(failed)?;
        let _ = file.try_lock(); // a file system without locks has none to respect either
        let written = file.write_all(content).and_then(|()| file.sync_all());
        let staged = Staged {
            temporary,
            path: path.to_owned(),
            lock: Some(file),
        };
        written.map_err(failed)?;
        Ok(staged)
    }

    /// Gives the file its name; returns its lock, for who needs it longer.
    pub(super) fn take_place(mut self) -> Result<Option<File>, FileError> {
        std::fs::rename(&self.temporary, &self.path).map_err(|e| FileError::Write {
            path: self.path.clone(),
            reason: plain(&e),
        })?;
        Ok(self.lock.take())
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The name of the temporary file.
    pub(super) fn temporary(&self) -> &Path {
        &self.temporary
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // After the rename there is nothing under this name; that it cannot be removed is no second error.
        let _ = std::fs::remove_file(&self.temporary);
    }
}

/// No two files of this process, nor of two at once, have the same.
fn temporary_name(name: &str) -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    format!(".{name}.{}_{number}{ENDING}", std::process::id())
}

const ENDING: &str = ".partial";

/// The name that a file under this temporary name is for; `None` for names that are no temporary ones.
pub(super) fn name_of(temporary: &str) -> Option<&str> {
    let (name, process) = temporary.strip_prefix('.')?.strip_suffix(ENDING)?.rsplit_once('.')?;
    let is_plain = !name.is_empty() && !name.contains('/') && process.bytes().all(|b| b.is_ascii_digit() || b == b'_');
    (is_plain && !process.is_empty()).then_some(name)
}
