//! A folder that a phone or a camera copies its photos into. Nothing in it is ever changed.

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use super::error::SourceError;
use super::frame::{FrameSource, Original, SourceFrame};
use scaleproof_core::files;
use scaleproof_core::message::message;
use scaleproof_photo::{Budget, Photo};

/// Interval at which the folder is listed.
const ROUND: Duration = Duration::from_millis(250);

/// A file counts once it has not changed for this long and decodes.
const STABLE: Duration = Duration::from_millis(500);

/// Time without a change after which a file that does not decode counts as bad; before, its rest may still arrive.
const PATIENCE: Duration = Duration::from_secs(4);

/// New photos in a folder, by name where several are ready at once.
pub struct Watch {
    folder: PathBuf,
    files: BTreeMap<PathBuf, WatchedFile>,
    ready: VecDeque<SourceFrame>,
    /// Ends when every file that is there was given, instead of waiting for more.
    ends: bool,
}

/// A file as it was when it last changed.
#[derive(Clone, Copy)]
struct WatchedFile {
    /// Size and time of change; only compared for being the same, so that a clock set back does no harm.
    state: (u64, Option<SystemTime>),
    since: Instant,
    is_done: bool,
}

impl Watch {
    /// Opens a folder. With `ends` the source ends when every file in it has been given; otherwise it waits for more.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn open(folder: &Path, ends: bool) -> Result<Watch, SourceError> {
        let mut watch = Watch {
            folder: folder.to_owned(),
            files: BTreeMap::new(),
            ready: VecDeque::new(),
            ends,
        };
        watch.look()?;
        Ok(watch)
    }

    /// Lists the folder, and reads what has become ready.
    fn look(&mut self) -> Result<(), SourceError> {
        let gone = |e: std::io::Error| {
            message!(
                "the watched folder {} cannot be read ({}): bring it back and run this again; what was accepted is kept",
                self.folder.display(),
                files::plain(&e)
            )
        };
        let mut there = Vec::new();
        for entry in std::fs::read_dir(&self.folder).map_err(gone)? {
            let path = entry.map_err(gone)?.path();
            let is_hidden = path.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
            // What cannot be looked at was removed meanwhile; pipes and folders are no photos, and a link leads out of the folder.
            match std::fs::symlink_metadata(&path) {
                Ok(about) if about.is_file() && !is_hidden => there.push((path, (about.len(), about.modified().ok()))),
                _ => {}
            }
        }
        there.sort();
        self.files
            .retain(|path, _| there.iter().any(|(known, _)| known == path));
        for (path, state) in there {
            let since = Instant::now();
            let new = WatchedFile {
                state,
                since,
                is_done: false,
            };
            let seen = self.files.entry(path.clone()).or_insert(new);
            if seen.state != state {
                *seen = new;
            }
            let age = since.duration_since(seen.since);
            if seen.is_done || age < STABLE {
                continue;
            }
            if let Some(original) = original(&path, state.0, age) {
                seen.is_done = true;
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                self.ready.push_back(SourceFrame::untimed(name, original));
            }
        }
        Ok(())
    }
}

/// Returns the bytes of a file that decodes, or the reason why there will be none; `None` while its rest may still arrive.
fn original(path: &Path, size: u64, age: Duration) -> Option<Original> {
    if size > Budget::FILE.bytes {
        let sentence = format!("{} is larger than a photo: move it out of the folder", path.display());
        return Some(Original::Unreadable(sentence));
    }
    let decoded = Photo::open(path).and_then(|photo| {
        // A cut JPEG is refused when it is opened, a cut PNG only when it is decoded.
        if photo.extension() == "png" {
            photo.luma()?;
        }
        Ok(photo.into_bytes())
    });
    (decoded.is_ok() || age >= PATIENCE).then(|| Original::from_file(decoded))
}

impl FrameSource for Watch {
    fn next(&mut self) -> Result<Option<SourceFrame>, SourceError> {
        loop {
            if let Some(frame) = self.ready.pop_front() {
                return Ok(Some(frame));
            }
            if self.ends && self.files.values().all(|seen| seen.is_done) {
                return Ok(None);
            }
            std::thread::sleep(ROUND);
            self.look()?;
        }
    }
}
