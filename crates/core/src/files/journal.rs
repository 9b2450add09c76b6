//! Files that take their places together: a note of what is to be renamed, by which the next run finishes what a killed one began.
//!
//! The note is written when every file is whole under its temporary name, and removed when the last has taken its place. Whoever holds its
//! lock is at work on it; the lock ends with the process. The next run that writes into the folder finishes it before anything else, or old
//! files would take the places of newer ones later.
//!
//! A line of the note is `INODE.CHANGED NAME`: the temporary file by its number and the time of its last change, which no program can choose. So a
//! folder from elsewhere, whose files have other numbers and times here, makes this program rename nothing, and no note reaches out of its folder.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, TryLockError};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

use super::error::FileError;
use super::inputs;
use super::path::folder_of;
use super::staged::{Staged, name_of, unique};

/// A temporary file that is younger may be about to be locked.
const AT_WORK: Duration = Duration::from_secs(10);

const ENDING: &str = ".scaleproof-journal";

struct Journal {
    path: PathBuf,
    _lock: Option<File>,
}

pub(super) fn persist_all(staged: Vec<Staged>) -> Result<(), FileError> {
    // One file is whole or absent by itself.
    let folders = match staged.len() {
        0 | 1 => BTreeMap::new(),
        _ => by_folder(&staged),
    };
    // Runs that finish at once in one folder take their turns, so that its files are all of one of them. In the order of the names, so that
    // no two wait for each other.
    let turns: Vec<Option<File>> = folders.keys().map(|folder| turn(folder)).collect::<Result<_, _>>()?;
    let journals = folders.iter().map(|(folder, lines)| Journal::write(folder, lines));
    let journals: Vec<Journal> = journals.collect::<Result<_, _>>()?;
    staged.into_iter().try_for_each(|file| file.persist().map(drop))?;
    drop(journals);
    drop(turns);
    Ok(())
}

/// Longest wait for the lock of a folder, which a run holds for as long as it renames its files.
const LONGEST_TURN: Duration = Duration::from_secs(10);

/// Locks a folder. Returns `None` where folders have no locks.
///
/// # Errors
/// Another program keeps the lock.
fn turn(folder: &Path) -> Result<Option<File>, FileError> {
    let Ok(file) = File::open(folder) else { return Ok(None) };
    let begin = Instant::now();
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(file)),
            Err(TryLockError::Error(_)) => return Ok(None),
            Err(TryLockError::WouldBlock) if begin.elapsed() < LONGEST_TURN => {
                std::thread::sleep(Duration::from_millis(20));
            }
            Err(TryLockError::WouldBlock) => {
                return Err(FileError::cannot_write(
                    folder,
                    "another program has held the folder's lock for ten seconds: end it, or name another output",
                ));
            }
        }
    }
}

/// Returns what tells a file from every other one, and from itself after a change: its number and the time of its last change. `None` where the
/// system does not say, or the file is not there.
#[cfg(unix)]
fn identity(path: &Path) -> Option<String> {
    use std::os::unix::fs::MetadataExt;
    let about = std::fs::symlink_metadata(path).ok()?;
    about
        .is_file()
        .then(|| format!("{}.{}.{}", about.ino(), about.ctime(), about.ctime_nsec()))
}

#[cfg(not(unix))]
fn identity(_: &Path) -> Option<String> {
    None
}

/// Sorts the lines of the notes by folder. However a folder is spelled, it is one: its lock taken twice would wait for itself.
fn by_folder(staged: &[Staged]) -> BTreeMap<PathBuf, Vec<String>> {
    let mut folders: BTreeMap<PathBuf, Vec<String>> = BTreeMap::new();
    for file in staged {
        // A name that is no line of text cannot be noted; the file is whole or absent all the same.
        let is_line = |path: &Path| path.file_name()?.to_str().filter(|name| !name.contains('\n')).map(drop);
        let name = is_line(&file.path).and_then(|()| file.temporary.file_name()?.to_str());
        let line = name.and_then(|name| Some(format!("{} {name}", identity(&file.temporary)?)));
        let folder = folder_of(&file.path);
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        let lines = folders.entry(folder).or_default();
        lines.extend(line);
    }
    folders
}

impl Journal {
    fn write(folder: &Path, lines: &[String]) -> Result<Journal, FileError> {
        let path = folder.join(format!(".{}{ENDING}", unique()));
        // It gets its name when it is whole and locked, so that nobody takes it for one left behind.
        let staged = Staged::write(&path, lines.join("\n").as_bytes())?;
        let lock = staged.persist()?;
        Ok(Journal { path, _lock: lock })
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Finishes what killed runs began in a folder, and removes what they left half-written. What cannot be tidied is left as it is: it is in
/// nobody's way. Each folder is looked at once in a run.
pub(super) fn tidy(folder: &Path) {
    static TIDIED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let is_new = TIDIED
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .insert(folder.to_owned());
    if is_new {
        tidy_now(folder);
    }
}

fn tidy_now(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.starts_with('.'))
        .collect();
    for name in names.iter().filter(|name| name.ends_with(ENDING)) {
        let path = folder.join(name);
        if let Some(file) = left_behind(&path) {
            finish(folder, file);
            let _ = std::fs::remove_file(&path);
        }
    }
    for name in names.iter().filter(|name| name_of(name).is_some()) {
        let path = folder.join(name);
        let Ok(about) = std::fs::symlink_metadata(&path) else {
            continue;
        };
        let age = about.modified().ok().and_then(|time| time.elapsed().ok());
        let is_free = inputs::refuse(&path).is_ok() && inputs::refuse_below(&path).is_ok();
        if is_free && age.is_some_and(|age| age >= AT_WORK) && left_behind(&path).is_some() {
            let _ = if about.is_dir() {
                std::fs::remove_dir_all(&path)
            } else {
                std::fs::remove_file(&path)
            };
        }
    }
}

/// Opens a regular file or a folder that no running program is at work on.
fn left_behind(path: &Path) -> Option<File> {
    let about = std::fs::symlink_metadata(path).ok()?;
    let file = (about.is_file() || about.is_dir()).then(|| File::open(path).ok())??;
    file.try_lock().ok()?;
    Some(file)
}

/// A note is no longer.
const MOST_NOTED: u64 = 1 << 20;

fn finish(folder: &Path, note: File) {
    let mut lines = String::new();
    if note.take(MOST_NOTED).read_to_string(&mut lines).is_err() {
        return;
    }
    for line in lines.lines() {
        let Some((noted, temporary)) = line.split_once(' ') else {
            continue;
        };
        let Some(name) = name_of(temporary) else { continue };
        let (from, to) = (folder.join(temporary), folder.join(name));
        let is_same = identity(&from).is_some_and(|identity| identity == noted);
        // What came after the killed run stays.
        if is_same && !to.is_dir() && modified(&to) <= modified(&from) && inputs::refuse(&to).is_ok() {
            let _ = std::fs::rename(&from, &to);
        }
    }
}

/// Returns the time of the last change; `None`, which is before any time, for what is not there.
fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::symlink_metadata(path).and_then(|about| about.modified()).ok()
}
