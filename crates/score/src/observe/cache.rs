//! Results kept from run to run: each result on a photo is computed once, whatever later runs use it for.
//!
//! An entry is named by everything it depends on: the photo's content, the detector's weights and how they are fed and read, this
//! very program file and its libraries. So nothing has to be thrown away when something changes, it is only not found any more.

use std::hash::{BuildHasher, RandomState};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::Serialize;
use serde::de::DeserializeOwned;

use scaleproof_core::files;

/// An entry is what was found in one photo: some kilobytes.
const MOST_BYTES: u64 = 256 << 20;

/// A folder of entries. Several threads, and several processes, may use one at the same time.
#[derive(Debug)]
pub struct Cache {
    folder: PathBuf,
    program: String,
    problems: Mutex<Problems>,
}

/// Problems with entries; none of them changes a result.
#[derive(Debug, Default)]
struct Problems {
    damaged: usize,
    first_damaged: Option<PathBuf>,
    not_written: Option<String>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key(String);

impl Cache {
    /// Opens the cache in a folder, which need not exist yet. Results of another build of this program, or with other `libraries`, are never taken.
    pub fn open(folder: &Path, libraries: &str) -> Result<Cache, files::FileError> {
        files::check_writable(folder)?;
        let program =
            std::env::current_exe().map_err(|e| files::FileError::read("the program's own file".as_ref(), &e))?;
        Ok(Cache {
            folder: folder.to_owned(),
            program: format!("{}\n{libraries}", files::sha256_hex(&files::read(&program)?)),
            problems: Mutex::default(),
        })
    }

    /// Returns the name of the entry that depends on these `parts`, and on the program.
    pub fn key(&self, parts: &[&str]) -> Key {
        let parts = [&[self.program.as_str()], parts].concat();
        // Each part with its length: no two lists of parts give the same text.
        let text: String = parts.iter().map(|part| format!("{} {part}\n", part.len())).collect();
        Key(files::sha256_hex(text.as_bytes()))
    }

    /// Returns an entry, if it is there and whole; a damaged one is remembered for [`Cache::complaints`].
    pub fn get<T: DeserializeOwned>(&self, key: &Key) -> Option<T> {
        let path = self.path(key);
        std::fs::symlink_metadata(&path).ok()?;
        let bytes = files::chosen::kept(&self.folder, &path, MOST_BYTES).unwrap_or_default();
        let value = bytes.split_at_checked(64).and_then(|(sum, content)| {
            let is_whole = sum == checksum(key, content).as_bytes();
            is_whole.then(|| postcard::from_bytes(content).ok()).flatten()
        });
        if value.is_none() {
            let mut problems = self.problems();
            problems.damaged += 1;
            problems.first_damaged.get_or_insert(path);
        }
        value
    }

    /// Writes an entry. A failure costs only the next run's time, so it is remembered and the run goes on.
    pub fn put<T: Serialize>(&self, key: &Key, value: &T) {
        let Err(reason) = self.write(key, value) else { return };
        self.problems().not_written.get_or_insert(reason);
    }

    fn write<T: Serialize>(&self, key: &Key, value: &T) -> Result<(), String> {
        let content = postcard::to_allocvec(value).map_err(|e| e.to_string())?;
        let path = self.path(key);
        let folder = path.parent().unwrap_or(&self.folder);
        files::chosen::folder(&self.folder, folder).map_err(|e| e.to_string())?;
        // Two threads, or processes on two machines, may keep the same entry at once: each has a name of its own until it is
        // whole. Nothing waits for the disk: after a power cut the checksum tells.
        let temporary = folder.join(format!(".{:016x}.partial", RandomState::new().hash_one(&key.0)));
        let bytes = [checksum(key, &content).into_bytes(), content].concat();
        let written = || {
            let mut file = files::chosen::new_file(&self.folder, &temporary)?;
            let failed = |e| files::FileError::write(&temporary, &e);
            file.write_all(&bytes).map_err(failed)?;
            files::chosen::rename(&self.folder, &temporary, &path)
        };
        written().map_err(|e| {
            let _ = files::chosen::remove(&self.folder, &temporary);
            e.to_string()
        })
    }

    /// Returns the problems of the cache, as sentences for the user.
    pub fn complaints(&self) -> Vec<String> {
        let problems = self.problems();
        let damaged = problems.first_damaged.as_ref().map(|first| {
            format!(
                "{} damaged entries of the cache were computed again and replaced; the first: {}",
                problems.damaged,
                first.display()
            )
        });
        let not_written = problems.not_written.as_ref().map(|reason| {
            format!(
                "results could not be kept in {} ({reason}): the next run computes them again",
                self.folder.display()
            )
        });
        damaged.into_iter().chain(not_written).collect()
    }

    /// Returns the path of an entry. Folders by the first two digits: file systems and people dislike folders of a hundred thousand files.
    pub fn path(&self, key: &Key) -> PathBuf {
        self.folder.join(&key.0[..2]).join(&key.0[2..])
    }

    fn problems(&self) -> std::sync::MutexGuard<'_, Problems> {
        self.problems.lock().unwrap_or_else(|e| e.into_inner())
    }
}

/// Returns the SHA-256 of an entry's name and content: an entry under another's name is no entry.
fn checksum(key: &Key, content: &[u8]) -> String {
    files::sha256_hex(&[key.0.as_bytes(), content].concat())
}
