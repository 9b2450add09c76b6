//! A whole file under a temporary name beside its place.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use super::error::FileError;
use super::inputs;
use super::path::folder_of;

/// Removed unless it takes its place. Its lock says that its program still runs.
pub(super) struct Staged {
    pub(super) temporary: PathBuf,
    pub(super) path: PathBuf,
    lock: Option<File>,
}

impl Staged {
    pub(super) fn write(path: &Path, content: &[u8]) -> Result<Staged, FileError> {
        let failed = |e| FileError::write(path, &e);
        if path.is_dir() {
            return Err(FileError::cannot_write(path, "a folder is in its place"));
        }
        if path.file_name().is_none() {
            return Err(FileError::cannot_write(path, "it is not a file name"));
        }
        std::fs::create_dir_all(folder_of(path)).map_err(failed)?;
        let (temporary, mut file) = new_beside(path, |at| File::create_new(at)).map_err(failed)?;
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
    pub(super) fn persist(mut self) -> Result<Option<File>, FileError> {
        std::fs::rename(&self.temporary, &self.path).map_err(|e| FileError::write(&self.path, &e))?;
        inputs::own(&self.path);
        Ok(self.lock.take())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // After the rename there is nothing under this name; that it cannot be removed is no second error.
        let _ = std::fs::remove_file(&self.temporary);
    }
}

/// Returns the process and a number of it, as in `4711_3`.
pub(super) fn unique() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    format!("{}_{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

const ENDING: &str = ".partial";

/// Returns the name that a file under this temporary name is for; `None` for names that are no temporary ones.
pub(super) fn name_of(temporary: &str) -> Option<&str> {
    let (name, numbers) = temporary.strip_prefix('.')?.strip_suffix(ENDING)?.rsplit_once('.')?;
    let (process, number) = numbers.split_once('_')?;
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let is_ours = !name.is_empty() && !name.contains('/') && is_number(process) && is_number(number);
    is_ours.then_some(name)
}

/// Returns true for a name under which this program writes a file or fills a folder until it is whole.
pub fn is_temporary(name: &str) -> bool {
    name_of(name).is_some()
}

/// Makes a new file or folder under a temporary name beside the place of the file or folder that it is for. What is there is never touched:
/// containers may number their processes alike, and a killed run of the same number may have left one.
pub(super) fn new_beside<T>(path: &Path, make: impl Fn(&Path) -> std::io::Result<T>) -> std::io::Result<(PathBuf, T)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    loop {
        let temporary = path.with_file_name(format!(".{name}.{}{}", unique(), ENDING));
        match make(&temporary) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            made => return made.map(|made| (temporary, made)),
        }
    }
}
