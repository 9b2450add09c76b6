//! Files: content hashes, and writing so that nothing half-written stays behind.

pub mod chosen;
pub mod environment;
pub mod inputs;
mod journal;
pub mod limit;
mod place;
mod staged;
mod state;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::message::{Message, message};
use crate::workers::interruption;
use place::OutputPlace;
use staged::Staged;
pub use state::FileState;

/// A file that could not be read or written, or that holds something else than it should; as a sentence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    #[error("cannot read {path}: {reason}", path = path.display())]
    Read { path: PathBuf, reason: String },
    #[error("cannot write {path}: {reason}", path = path.display())]
    Write { path: PathBuf, reason: String },
    #[error("{path}, line {line}: {message}", path = path.display())]
    Syntax {
        path: PathBuf,
        line: usize,
        message: String,
    },
    #[error("{path}: {message}", path = path.display())]
    Content { path: PathBuf, message: String },
    #[error("{path} is an input, which would be overwritten; give another output file", path = path.display())]
    IsInput { path: PathBuf },
    #[error("two files would be written as {path}; give them different names", path = path.display())]
    Twice { path: PathBuf },
}

impl From<FileError> for Message {
    fn from(error: FileError) -> Message {
        message!("{error}").caused_by(error)
    }
}

impl FileError {
    pub fn content(path: &Path, message: impl ToString) -> FileError {
        let (path, message) = (path.to_owned(), message.to_string());
        FileError::Content { path, message }
    }

    pub fn syntax(path: &Path, line: usize, message: String) -> FileError {
        let path = path.to_owned();
        FileError::Syntax { path, line, message }
    }

    pub fn read(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_read(path, plain(e))
    }

    pub fn write(path: &Path, e: &std::io::Error) -> FileError {
        FileError::cannot_write(path, plain(e))
    }

    /// A file that could not be read, for a reason that is no error of the system.
    pub fn cannot_read(path: &Path, reason: impl Into<String>) -> FileError {
        let (path, reason) = (path.to_owned(), reason.into());
        FileError::Read { path, reason }
    }

    /// A file that could not be written, for a reason that is no error of the system.
    pub fn cannot_write(path: &Path, reason: impl Into<String>) -> FileError {
        let (path, reason) = (path.to_owned(), reason.into());
        FileError::Write { path, reason }
    }
}

/// A file or folder that lies beside the running program, as in an unpacked archive; `None` when it is not there.
pub fn beside_the_program(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?.canonicalize().ok()?;
    let path = program.parent()?.join(name);
    path.exists().then_some(path)
}

/// No file that this program reads whole is larger: a frame set's list, a COCO file and a network's weights have some hundred megabytes.
const MOST_BYTES: u64 = 4 << 30;

/// Reads a whole file of up to 4 GiB.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    read_at_most(path, MOST_BYTES)
}

/// About a folder in a file's place: what it has of the files that are named by their folder most often.
fn not_a_file(path: &Path) -> String {
    let usual = ["pattern.png", "scene.toml", "camera.yaml", "session.json"];
    let inside: Vec<String> = usual
        .iter()
        .map(|name| path.join(name))
        .filter(|inside| inside.is_file())
        .map(|inside| inside.display().to_string())
        .collect();
    if inside.is_empty() {
        "it is not a file".to_owned()
    } else {
        format!("it is not a file; it holds {}", inside.join(", "))
    }
}

/// Reads a whole file, and refuses one of more than `most_bytes` before it takes memory.
pub fn read_at_most(path: &Path, most_bytes: u64) -> Result<Vec<u8>, FileError> {
    let failed = |e| FileError::read(path, &e);
    let about = std::fs::metadata(path).map_err(failed)?;
    inputs::note(path);
    // Reading a named pipe would wait for ever.
    if !about.is_file() {
        return Err(FileError::cannot_read(path, not_a_file(path)));
    }
    let mut bytes = Vec::new();
    if about.len() <= most_bytes {
        // Room for the whole file, so that the buffer is not copied as it fills. The file may grow meanwhile.
        let no_room = |_| FileError::cannot_read(path, "the memory does not suffice for it");
        bytes.try_reserve_exact(about.len() as usize + 1).map_err(no_room)?;
        let file = File::open(path).map_err(failed)?;
        file.take(most_bytes + 1).read_to_end(&mut bytes).map_err(failed)?;
    }
    if about.len().max(bytes.len() as u64) > most_bytes {
        let reason = format!("it has more than the {} MB that are read", most_bytes >> 20);
        return Err(FileError::cannot_read(path, reason));
    }
    Ok(bytes)
}

/// Texts are smaller than networks: the annotations of a large set have some hundred megabytes.
const MOST_TEXT: u64 = 1 << 30;

/// Reads a whole UTF-8 text file of up to 1 GiB.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    read_text_at_most(path, MOST_TEXT)
}

/// As [`read_at_most`], of a UTF-8 text.
pub fn read_text_at_most(path: &Path, most_bytes: u64) -> Result<String, FileError> {
    String::from_utf8(read_at_most(path, most_bytes)?).map_err(|_| FileError::cannot_read(path, "it is not UTF-8 text"))
}

/// Writes an output that a user named: [`write_all_atomically`] of one file.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_all_atomically(&[(path, content)])
}

pub fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout"].iter().any(|name| path == Path::new(name))
}

/// Whether an output is written to as a stream: standard output, a named pipe or a character device.
pub fn is_stream(path: &Path) -> Result<bool, FileError> {
    Ok(matches!(OutputPlace::at(path)?, OutputPlace::Stream(_)))
}

/// Writes outputs that a user named, together: each is whole under a temporary name before the first takes its place, and a run that is
/// killed between two of them leaves a note by which the next one that writes into the folder finishes (`journal.rs`). Missing parent
/// folders are made.
///
/// A symbolic link stays, and its target is written. Standard output (`-`), pipes and character devices are written to. What is neither is
/// refused before anything is written, and so is the place of an input ([`inputs`]).
pub fn write_all_atomically(files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    write_some_named(files, |_| true)
}

/// Writes outputs as [`write_all_atomically`] does, of which a user named these alone: the names of the others this program made of them, so that a
/// link in the place of one is replaced and never followed ([`chosen`]).
pub fn write_beside(named: &[&Path], files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    write_some_named(files, |path| named.contains(&path))
}

fn write_some_named(
    files: &[(impl AsRef<Path>, impl AsRef<[u8]>)],
    is_named: impl Fn(&Path) -> bool,
) -> Result<(), FileError> {
    let (mut regular, mut streams) = (Vec::new(), Vec::new());
    for (path, content) in files {
        let path = path.as_ref();
        if !is_named(path) {
            chosen::check(path.parent().unwrap_or(Path::new("")), path)?;
            regular.push((path.to_owned(), content));
            continue;
        }
        match OutputPlace::at(path)? {
            OutputPlace::File(path) => regular.push((path, content)),
            OutputPlace::Stream(stream) => streams.push((stream, content)),
        }
    }
    inputs::refuse_twice(regular.iter().map(|(path, _)| path.as_path()))?;
    replace_all(&regular)?;
    let mut streams = streams.into_iter();
    streams.try_for_each(|(stream, content)| place::write_to(&stream, content.as_ref()))
}

/// Writes files whose names this program chose below a folder that a user named, together, as [`write_all_atomically`] does. A link in the place
/// of one is replaced, and one in the place of a folder between is refused ([`chosen`]): the folder may come from somebody else.
pub fn replace_all_atomically(home: &Path, files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    files
        .iter()
        .try_for_each(|(path, _)| chosen::check(home, path.as_ref()))?;
    replace_all(files)
}

fn replace_all(files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<(), FileError> {
    interruption::check();
    files.iter().try_for_each(|(path, _)| inputs::refuse(path.as_ref()))?;
    let mut staged = Vec::new();
    for (path, content) in files {
        journal::tidy(folder_of(path.as_ref()));
        staged.push(Staged::write(path.as_ref(), content.as_ref())?);
    }
    interruption::check();
    journal::persist_all(staged)
}

/// Writes one file as [`replace_all_atomically`] does, without a look at what killed runs left in the folder.
pub fn replace_atomically(home: &Path, path: &Path, content: &[u8]) -> Result<(), FileError> {
    chosen::check(home, path)?;
    inputs::refuse(path)?;
    Staged::write(path, content)?.persist().map(drop)
}

/// Finds out, before long work, that a folder is or can be made there and takes files. Makes nothing.
pub fn check_writable(folder: &Path) -> Result<(), FileError> {
    let there = folder
        .ancestors()
        .map(|f| if f.as_os_str().is_empty() { Path::new(".") } else { f })
        .find(|f| f.exists());
    match there {
        Some(there) if there.is_dir() => takes_files(there),
        Some(file) => Err(FileError::cannot_write(folder, format!("{} is a file", file.display()))),
        None => Err(FileError::cannot_write(folder, "no part of the path exists")),
    }
}

/// By a file that is gone again at once; what killed runs left in the folder goes, too.
fn takes_files(folder: &Path) -> Result<(), FileError> {
    journal::tidy(folder);
    let probe = folder.join(".scaleproof");
    let made = new_beside(&probe, |at| File::create_new(at).and_then(|_| std::fs::remove_file(at)));
    made.map(drop).map_err(|e| FileError::write(&probe, &e))
}

/// Finds out, before long work, that a file that a user named can be written: its folder takes files, or it is a stream. Makes nothing.
pub fn check_file_writable(path: &Path) -> Result<(), FileError> {
    match OutputPlace::at(path)? {
        OutputPlace::File(path) => {
            inputs::refuse(&path)?;
            check_writable(folder_of(&path))
        }
        OutputPlace::Stream(_) => Ok(()),
    }
}

/// The whole path of a file or folder, without links.
pub fn whole_path(path: &Path) -> Result<PathBuf, FileError> {
    path.canonicalize().map_err(|e| FileError::read(path, &e))
}

/// Whether two paths lead to one file or folder that is there.
pub fn is_same(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The path where nothing is there, else one numbered beside it: what an advice names as an output.
pub fn free_place(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().display();
    let ending = path
        .extension()
        .map_or(String::new(), |ending| format!(".{}", ending.display()));
    let numbered = (2..).map(|number| path.with_file_name(format!("{stem}_{number}{ending}")));
    let mut places = std::iter::once(path.to_owned()).chain(numbered);
    places
        .find(|place| place.symlink_metadata().is_err())
        .unwrap_or_default()
}

/// The folder that a path lies in; `.` for a mere name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// Returns true for a name under which this program writes a file or fills a folder until it is whole.
pub fn is_temporary(name: &str) -> bool {
    staged::name_of(name).is_some()
}

/// Makes a new file or folder under a temporary name beside the place of the file or folder that it is for. What is there is never touched:
/// containers may number their processes alike, and a killed run of the same number may have left one.
fn new_beside<T>(path: &Path, make: impl Fn(&Path) -> std::io::Result<T>) -> std::io::Result<(PathBuf, T)> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    loop {
        let temporary = path.with_file_name(format!(".{name}.{}{}", staged::unique(), staged::ENDING));
        match make(&temporary) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            made => return made.map(|made| (temporary, made)),
        }
    }
}

/// Makes the folder that a user named, and those on its way, where they are missing.
pub fn make_named_folder(folder: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder).map_err(|e| FileError::write(folder, &e))
}

/// Removes a folder that a user named, where nothing lies in it.
pub fn remove_if_empty(folder: &Path) {
    // What cannot be removed is in nobody's way.
    let _ = std::fs::remove_dir(folder);
}

/// Makes a folder where nothing is, or an empty one: `fill` writes its files under a temporary name beside it, then it takes its place. What
/// fails leaves nothing behind.
pub fn make_folder(path: &Path, fill: impl FnOnce(&Path) -> Result<(), FileError>) -> Result<(), FileError> {
    let failed = |e| FileError::write(path, &e);
    if path.file_name().is_none() {
        return Err(FileError::cannot_write(path, "it is not a folder's name"));
    }
    std::fs::create_dir_all(folder_of(path)).map_err(failed)?;
    journal::tidy(folder_of(path));
    let (temporary, ()) = new_beside(path, |at| std::fs::create_dir(at)).map_err(failed)?;
    // Its lock says that this program is at work on it; where folders have no locks, nobody removes what is left behind.
    let lock = File::open(&temporary).ok().filter(|folder| folder.try_lock().is_ok());
    let made = fill(&temporary).and_then(|()| std::fs::rename(&temporary, path).map_err(failed));
    if made.is_err() {
        let _ = std::fs::remove_dir_all(&temporary);
    }
    drop(lock);
    made
}

/// Copies a file into a folder that is being made; missing folders on its way are made too.
pub fn copy(from: &Path, to: &Path) -> Result<(), FileError> {
    let failed = |e| FileError::cannot_write(to, format!("copying {} failed: {}", from.display(), plain(&e)));
    std::fs::create_dir_all(folder_of(to)).map_err(failed)?;
    inputs::note(from);
    // Reading a named pipe would wait for ever.
    if !from.metadata().map_err(failed)?.is_file() {
        return Err(FileError::cannot_read(from, not_a_file(from)));
    }
    std::fs::copy(from, to).map(drop).map_err(failed)
}

/// Links to a file from a folder that is being made; where the system has no links, it is copied.
pub fn link(from: &Path, to: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(folder_of(to)).map_err(|e| FileError::write(to, &e))?;
    #[cfg(unix)]
    return std::os::unix::fs::symlink(whole_path(from)?, to).map_err(|e| FileError::write(to, &e));
    #[cfg(not(unix))]
    copy(from, to)
}

/// SHA-256 of some bytes, in lower-case hex.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// SHA-256 of a file of any length, in lower-case hex, read in parts.
pub fn sha256_of_file(path: &Path) -> Result<String, FileError> {
    let failed = |e| FileError::read(path, &e);
    inputs::note(path);
    if !path.metadata().map_err(failed)?.is_file() {
        return Err(FileError::cannot_read(path, not_a_file(path)));
    }
    let (mut file, mut hash) = (File::open(path).map_err(failed)?, Sha256::new());
    let mut part = vec![0; 1 << 20];
    loop {
        match file.read(&mut part).map_err(failed)? {
            0 => break,
            count => hash.update(&part[..count]),
        }
    }
    Ok(hex(&hash.finalize()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// The last part of a path; a path without one stays whole.
pub fn name_of(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// A file's name with its SHA-256.
pub fn hashed(path: &Path) -> Result<(String, String), FileError> {
    Ok((name_of(path), sha256_hex(&read(path)?)))
}

/// An operating system error without its "(os error 2)".
pub fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}
