//! Files: content hashes, and writing so that nothing half-written stays behind.

use std::io::Write;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// A file that could not be read or written, as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    #[error("cannot read {path}: {reason}", path = path.display())]
    Read { path: PathBuf, reason: String },
    #[error("cannot write {path}: {reason}", path = path.display())]
    Write { path: PathBuf, reason: String },
}

/// Reads a whole file.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    let failed = |reason: String| FileError::Read {
        path: path.to_owned(),
        reason,
    };
    // Reading a named pipe would wait for ever.
    match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => return Err(failed("it is not a file".into())),
        Ok(_) => {}
        Err(e) => return Err(failed(plain(&e))),
    }
    std::fs::read(path).map_err(|e| failed(plain(&e)))
}

/// Reads a whole UTF-8 text file.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    String::from_utf8(read(path)?).map_err(|_| FileError::Read {
        path: path.to_owned(),
        reason: "it is not UTF-8 text".into(),
    })
}

/// Writes a file under a temporary name beside its place, then renames it, so that a reader sees the old file or the whole
/// new one. Missing parent folders are made.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let waiting = Waiting::write(path, content)?;
    waiting.take_place()
}

/// Writes several files, or none: every one is whole under its temporary name before the first takes its place.
pub fn write_all_atomically(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let waiting = files
        .iter()
        .map(|(path, content)| Waiting::write(path, content))
        .collect::<Result<Vec<_>, _>>()?;
    waiting.into_iter().try_for_each(Waiting::take_place)
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
        Some(there) if there.is_dir() => Waiting::write(&there.join(".scaleproof"), b"").map(drop),
        Some(file) => Err(failed(format!("{} is a file", file.display()))),
        None => Err(failed("no part of the path exists".into())),
    }
}

/// Removes a file; that there is none is fine.
pub fn remove(path: &Path) -> Result<(), FileError> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(FileError::Write {
            path: path.to_owned(),
            reason: plain(&e),
        }),
        _ => Ok(()),
    }
}

/// A whole file under a temporary name, removed unless it takes its place.
struct Waiting {
    temporary: PathBuf,
    path: PathBuf,
}

impl Waiting {
    fn write(path: &Path, content: &[u8]) -> Result<Waiting, FileError> {
        let failed = |e: std::io::Error| FileError::Write {
            path: path.to_owned(),
            reason: plain(&e),
        };
        if path.is_dir() {
            return Err(FileError::Write {
                path: path.to_owned(),
                reason: "a folder is in its place".into(),
            });
        }
        let Some(name) = path.file_name() else {
            return Err(FileError::Write {
                path: path.to_owned(),
                reason: "it is not a file name".into(),
            });
        };
        if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(failed)?;
        }
        let temporary = path.with_file_name(format!(".{}.{}.partial", name.to_string_lossy(), std::process::id()));
        let waiting = Waiting {
            temporary,
            path: path.to_owned(),
        };
        let mut file = std::fs::File::create(&waiting.temporary).map_err(failed)?;
        file.write_all(content).and_then(|()| file.sync_all()).map_err(failed)?;
        Ok(waiting)
    }

    fn take_place(self) -> Result<(), FileError> {
        std::fs::rename(&self.temporary, &self.path).map_err(|e| FileError::Write {
            path: self.path.clone(),
            reason: plain(&e),
        })
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        // After the rename there is nothing under this name; that it cannot be removed is no second error.
        let _ = std::fs::remove_file(&self.temporary);
    }
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
