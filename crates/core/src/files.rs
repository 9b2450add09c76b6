//! Files: content hashes, and writing so that nothing half-written stays behind.

pub mod environment;
mod journal;
mod place;
mod staged;
mod whole_folder;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use place::OutputPlace;
use staged::Staged;

pub use whole_folder::{copy, link, make_folder};

/// A file that could not be read or written, or that holds something else than it should; as a sentence.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // each variant is its sentence
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
        let (path, reason) = (path.to_owned(), plain(e));
        FileError::Read { path, reason }
    }

    pub fn write(path: &Path, e: &std::io::Error) -> FileError {
        let (path, reason) = (path.to_owned(), plain(e));
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

/// Reads a whole file, and refuses one of more than `most_bytes` before it takes memory.
pub fn read_at_most(path: &Path, most_bytes: u64) -> Result<Vec<u8>, FileError> {
    let failed = |reason: String| FileError::Read {
        path: path.to_owned(),
        reason,
    };
    let too_large = || failed(format!("it has more than the {} MB that are read", most_bytes >> 20));
    // Reading a named pipe would wait for ever.
    match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => return Err(failed("it is not a file".into())),
        Ok(about) if about.len() > most_bytes => return Err(too_large()),
        Ok(_) => {}
        Err(e) => return Err(failed(plain(&e))),
    }
    let mut bytes = Vec::new();
    // It may grow meanwhile.
    let read = File::open(path).and_then(|file| file.take(most_bytes + 1).read_to_end(&mut bytes));
    match read {
        Err(e) => Err(failed(plain(&e))),
        Ok(count) if count as u64 > most_bytes => Err(too_large()),
        Ok(_) => Ok(bytes),
    }
}

/// Texts are smaller than networks: the annotations of a large set have some hundred megabytes.
const MOST_TEXT: u64 = 1 << 30;

/// Reads a whole UTF-8 text file of up to 1 GiB.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    String::from_utf8(read_at_most(path, MOST_TEXT)?).map_err(|_| FileError::Read {
        path: path.to_owned(),
        reason: "it is not UTF-8 text".into(),
    })
}

/// Writes an output that a user named: [`write_all_atomically`] of one file.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    write_together(&[(path, content)])
}

/// Whether an output is named as standard output.
pub fn is_standard_output(path: &Path) -> bool {
    ["-", "/dev/stdout"].iter().any(|name| path == Path::new(name))
}

/// Whether an output is written to as a stream: standard output, a named pipe or a character device.
///
/// # Errors
/// What lies in its place can be neither replaced nor written to.
pub fn is_stream(path: &Path) -> Result<bool, FileError> {
    Ok(matches!(OutputPlace::of(path)?, OutputPlace::Stream(_)))
}

/// Writes outputs that a user named, together: each is whole under a temporary name before the first takes its place, and a run that is
/// killed between two of them leaves a note by which the next one that writes into the folder finishes (`journal.rs`). Missing parent
/// folders are made.
///
/// A symbolic link stays, and its target is written. Standard output (`-`), pipes and character devices are written to. What is neither is
/// refused before anything is written.
pub fn write_all_atomically(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let borrowed: Vec<_> = files
        .iter()
        .map(|(path, content)| (path.as_path(), content.as_slice()))
        .collect();
    write_together(&borrowed)
}

fn write_together(files: &[(&Path, &[u8])]) -> Result<(), FileError> {
    let (mut regular, mut streams) = (Vec::new(), Vec::new());
    for (path, content) in files {
        match OutputPlace::of(path)? {
            OutputPlace::File(path) => regular.push((path, *content)),
            OutputPlace::Stream(stream) => streams.push((stream, *content)),
        }
    }
    replace_together(&regular)?;
    streams
        .into_iter()
        .try_for_each(|(stream, content)| stream.write(content))
}

/// Writes files whose names this program chose into a folder that a user named, together, as [`write_all_atomically`] does. A symbolic link in
/// the place of one is replaced, never followed: the folder may come from somebody else.
pub fn replace_all_atomically(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let borrowed: Vec<_> = files
        .iter()
        .map(|(path, content)| (path.clone(), content.as_slice()))
        .collect();
    replace_together(&borrowed)
}

fn replace_together(files: &[(PathBuf, &[u8])]) -> Result<(), FileError> {
    let mut staged = Vec::new();
    for (path, content) in files {
        journal::tidy(folder_of(path));
        staged.push(Staged::write(path, content)?);
    }
    journal::persist_all(staged)
}

/// Writes one file as [`replace_all_atomically`] does, without a look at what killed runs left in the folder.
pub fn replace_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    Staged::write(path, content)?.persist().map(drop)
}

/// Finds out, before long work, that a folder is or can be made there and takes files. Makes nothing.
pub fn check_writable(folder: &Path) -> Result<(), FileError> {
    let failed = |reason: String| FileError::Write {
        path: folder.to_owned(),
        reason,
    };
    let there = folder
        .ancestors()
        .map(|f| if f.as_os_str().is_empty() { Path::new(".") } else { f })
        .find(|f| f.exists());
    match there {
        Some(there) if there.is_dir() => Staged::write(&there.join(".scaleproof"), b"").map(drop),
        Some(file) => Err(failed(format!("{} is a file", file.display()))),
        None => Err(failed("no part of the path exists".into())),
    }
}

/// Finds out, before long work, that a file that a user named can be written: its folder takes files, or it is a stream. Makes nothing.
pub fn check_file_writable(path: &Path) -> Result<(), FileError> {
    match OutputPlace::of(path)? {
        OutputPlace::File(path) => check_writable(folder_of(&path)),
        OutputPlace::Stream(_) => Ok(()),
    }
}

/// Removes a file; that there is none is fine.
pub fn remove(path: &Path) -> Result<(), FileError> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(FileError::write(path, &e)),
        _ => Ok(()),
    }
}

/// The whole path of a file or folder, without links.
pub fn whole_path(path: &Path) -> Result<PathBuf, FileError> {
    path.canonicalize().map_err(|e| FileError::read(path, &e))
}

fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

/// SHA-256 of some bytes, in lower-case hex.
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// An operating system error without its "(os error 2)".
pub fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_sha256() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(
            sha256_hex(b"abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    #[test]
    fn a_failed_write_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("report");
        std::fs::create_dir(&target).unwrap();
        let error = write_atomically(&target, b"x").unwrap_err().to_string();
        assert!(error.starts_with("cannot write"), "{error}");
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "only the folder that was there before");
    }

    #[test]
    fn files_written_together_appear_together_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let contents = ["a", "b"].map(|name| (folder.path().join(name), name.as_bytes().to_vec()));
        std::fs::create_dir(folder.path().join("b")).unwrap();
        assert!(write_all_atomically(&contents).is_err());
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            1,
            "neither `a` nor a temporary file"
        );
        std::fs::remove_dir(folder.path().join("b")).unwrap();
        write_all_atomically(&contents).unwrap();
        assert_eq!(std::fs::read(folder.path().join("b")).unwrap(), b"b");
    }
}
