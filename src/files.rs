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
    std::fs::read(path).map_err(|e| FileError::Read {
        path: path.to_owned(),
        reason: plain(&e),
    })
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
    let temporary = temporary_name(path);
    let renamed = || std::fs::rename(&temporary, path).map_err(|e| not_written(path, &e));
    stage(path, content).and_then(|()| renamed()).inspect_err(|_| {
        // Only our own temporary file is removed; that it may not exist is no second error.
        let _ = std::fs::remove_file(&temporary);
    })
}

/// Writes several files, or none: every one is whole under its temporary name before the first gets its own.
pub fn write_all_atomically(files: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
    let mut staged: Vec<PathBuf> = Vec::new();
    let result = files.iter().try_for_each(|(path, content)| {
        refuse_folder(path)?;
        staged.push(temporary_name(path));
        stage(path, content)
    });
    let result = result.and_then(|()| {
        let mut pairs = files.iter().zip(&staged);
        pairs.try_for_each(|((path, _), temporary)| std::fs::rename(temporary, path).map_err(|e| not_written(path, &e)))
    });
    if result.is_err() {
        // Only our own temporary files are removed; that some do not exist is no second error.
        staged
            .iter()
            .for_each(|temporary| drop(std::fs::remove_file(temporary)));
    }
    result
}

/// A folder under a file's name would be found out only when other files are in place already.
fn refuse_folder(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        let reason = "a folder has that name".into();
        return Err(FileError::Write {
            path: path.to_owned(),
            reason,
        });
    }
    Ok(())
}

/// Writes a file under its temporary name; missing parent folders are made.
fn stage(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let write = || {
        if let Some(folder) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder)?;
        }
        let mut file = std::fs::File::create(temporary_name(path))?;
        file.write_all(content)?;
        file.sync_all()
    };
    write().map_err(|e| not_written(path, &e))
}

fn not_written(path: &Path, e: &std::io::Error) -> FileError {
    FileError::Write {
        path: path.to_owned(),
        reason: plain(e),
    }
}

fn temporary_name(path: &Path) -> PathBuf {
    let name = path
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.partial", std::process::id()))
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
}
