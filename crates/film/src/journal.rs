//! What was looked at, a line a frame, so that an interrupted run goes on where it was. It belongs to one video, scene and camera.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::look::{GROUP, Look};
use scaleproof_core::files::{self, FileError};

/// Lines that are written at once; what was not written is looked at again.
const AT_ONCE: usize = 64;
/// Ten hours at 30 looks a second have a million lines of some 1800 bytes.
const MOST_BYTES: u64 = 1 << 31;

/// What a journal is about: the same for a run that goes on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct About {
    /// The program that looked; another may look otherwise.
    pub program: String,
    /// SHA-256 of the video, the scene and the camera file, hex.
    pub video: String,
    pub scene: String,
    pub camera: String,
    /// Which frames: `--from`, `--to` and `--every`.
    pub from_s: f64,
    pub to_s: Option<f64>,
    pub every: u64,
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    to: BufWriter<File>,
    waiting: usize,
}

impl Journal {
    /// Opens the journal at a place, and returns what it says already of whole groups of frames. One about something else, or that is damaged, begins again.
    ///
    /// # Errors
    /// A place that cannot be written.
    pub fn open(path: &Path, about: &About) -> Result<(Journal, Vec<Look>), FileError> {
        files::inputs::own(path);
        let known = files::read_at_most(path, MOST_BYTES);
        let mut looks = known.ok().and_then(|bytes| read(&bytes, about)).unwrap_or_default();
        looks.truncate(looks.len() - looks.len() % GROUP);
        let failed = |e: std::io::Error| FileError::write(path, &e);
        let wrong = |e: serde_json::Error| FileError::cannot_write(path, e.to_string());
        // Written again: the last line may be half a line.
        let mut to = BufWriter::new(File::create(path).map_err(failed)?);
        let head = serde_json::to_string(about).map_err(wrong)?;
        writeln!(to, "{head}").map_err(failed)?;
        let mut journal = Journal {
            path: path.to_owned(),
            to,
            waiting: 0,
        };
        looks.iter().try_for_each(|look| journal.add(look))?;
        journal.flush()?;
        Ok((journal, looks))
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// A full disk.
    pub fn add(&mut self, look: &Look) -> Result<(), FileError> {
        let line = line(look).ok_or_else(|| FileError::cannot_write(&self.path, "a frame makes no line"))?;
        writeln!(self.to, "{line}").map_err(|e| FileError::write(&self.path, &e))?;
        self.waiting += 1;
        if self.waiting < AT_ONCE {
            return Ok(());
        }
        self.flush()
    }

    /// Writes what waits.
    ///
    /// # Errors
    /// A full disk.
    pub fn flush(&mut self) -> Result<(), FileError> {
        self.waiting = 0;
        self.to.flush().map_err(|e| FileError::write(&self.path, &e))
    }

    /// Removes it: the run is done.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(self) -> Result<(), FileError> {
        files::remove(&self.path)
    }
}

/// The frames of a journal about this, up to the first line that is none or is out of order.
pub fn read(bytes: &[u8], about: &About) -> Option<Vec<Look>> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.lines();
    let head: About = serde_json::from_str(lines.next()?).ok()?;
    if head != *about {
        return None;
    }
    let mut looks: Vec<Look> = Vec::new();
    for line in lines {
        let Some(look) = look(line) else {
            break;
        };
        let is_next = looks
            .last()
            .is_none_or(|last| last.number < look.number && last.time_s < look.time_s);
        if !is_next {
            break;
        }
        looks.push(look);
    }
    Some(looks)
}

/// A frame as a line: postcard's bytes in hex, since floats must come back bit for bit, which JSON's do not.
fn line(look: &Look) -> Option<String> {
    let bytes = postcard::to_allocvec(look).ok()?;
    Some(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The frame of a line.
fn look(line: &str) -> Option<Look> {
    let pairs = line.as_bytes().chunks(2);
    let byte = |pair: &[u8]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
    let bytes: Vec<u8> = pairs.map(byte).collect::<Option<_>>()?;
    let (look, rest) = postcard::take_from_bytes(&bytes).ok()?;
    rest.is_empty().then_some(look)
}
