//! The files that this run has read: no output may take the place of one.
//!
//! Only a program of one command knows what its inputs are, so nothing is kept before [`guard`]: a library's caller may well read a file,
//! change it and write it again.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::error::FileError;
use super::path::folder_of;
use crate::message::bail;

/// Whole paths without links.
#[derive(Default)]
struct KnownFiles {
    read: BTreeSet<PathBuf>,
    /// Files that this run wrote: no inputs, although they may be read again.
    written: BTreeSet<PathBuf>,
}

static KNOWN: Mutex<Option<KnownFiles>> = Mutex::new(None);

fn known() -> MutexGuard<'static, Option<KnownFiles>> {
    KNOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes every file that is read from here on an input of this run, over which nothing is written.
pub fn guard() {
    known().get_or_insert_default();
}

/// Makes a file an input of this run without reading it: one that another input names, as a mesh names its images.
pub fn note(path: &Path) {
    let mut known = known();
    let Some(known) = known.as_mut() else { return };
    if let Ok(path) = path.canonicalize()
        && !known.written.contains(&path)
    {
        known.read.insert(path);
    }
}

pub(super) fn refuse(path: &Path) -> Result<(), FileError> {
    let is_input = known().as_ref().is_some_and(|known| known.read.contains(&place(path)));
    if is_input {
        Err(FileError::is_input(path))
    } else {
        Ok(())
    }
}

/// Refuses a folder that an input lies in.
pub(super) fn refuse_below(folder: &Path) -> Result<(), FileError> {
    let place = place(folder);
    let known = known();
    let inside = known
        .as_ref()
        .and_then(|known| known.read.iter().find(|read| read.starts_with(&place)));
    inside.map_or(Ok(()), |path| Err(FileError::is_input(path)))
}

pub(super) fn refuse_twice<'a>(outputs: impl IntoIterator<Item = &'a Path>) -> Result<(), FileError> {
    let mut places = BTreeSet::new();
    let mut again = outputs.into_iter().filter(|path| !places.insert(place(path)));
    let Some(path) = again.next() else { return Ok(()) };
    bail!(
        "two files would be written as {}; give them different names",
        path.display()
    )
}

/// Makes a file this run's own, unless it was read before: a checkpoint, say, or the list of a session that goes on. It may be read from here
/// on, and written again. What this run writes is its own by itself.
pub fn own(path: &Path) {
    let mut known = known();
    if let Some(known) = known.as_mut() {
        let place = place(path);
        if !known.read.contains(&place) {
            known.written.insert(place);
        }
    }
}

/// Returns the whole path of a file that may not be there yet.
fn place(path: &Path) -> PathBuf {
    let in_folder = || Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
    let place = path.canonicalize().ok().or_else(in_folder);
    place.unwrap_or_else(|| path.to_owned())
}
