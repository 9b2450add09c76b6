//! The file that a resumed run goes on from; floats come back bit for bit. It begins with the SHA-256 of the rest, as hex: a damaged one would go
//! on to another pattern.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::history::Entry;
use crate::AttackError;
use scaleproof_core::files;

pub const FILE: &str = "checkpoint";
/// Longest time between two checkpoints.
pub const AT_MOST: Duration = Duration::from_secs(20);

/// Hexadecimal digits of a SHA-256.
const HASH_LENGTH: usize = 64;

/// Content of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// All that the run depends on ([`key`]).
    key: String,
    /// Number of steps done.
    pub steps: u32,
    pub history: Vec<Entry>,
    /// State of the method.
    pub content: Vec<u8>,
}

/// Longest value of a setting in a key; longer ones are their SHA-256.
const LONGEST_VALUE: usize = 60;

/// Encodes all that a run depends on as JSON: each setting with its value.
pub fn key(settings: &impl Serialize) -> Result<String, AttackError> {
    let settings: BTreeMap<String, Value> = serde_json::from_value(serde_json::to_value(settings)?)?;
    let short = |value: Value| match value.to_string() {
        text if text.len() > LONGEST_VALUE => files::sha256_hex(text.as_bytes()),
        text => text,
    };
    let short: BTreeMap<_, _> = settings.into_iter().map(|(name, value)| (name, short(value))).collect();
    Ok(serde_json::to_string(&short)?)
}

/// Lists the settings in which two runs differ, in brackets: `(batch 2, here 4; detectors)`. Nothing for a checkpoint of another version, which says less.
fn differences(theirs: &str, ours: &str) -> String {
    let read = |key| serde_json::from_str::<BTreeMap<String, String>>(key).unwrap_or_default();
    let (theirs, ours) = (read(theirs), read(ours));
    let is_short = |value: &String| value.len() <= 16;
    let differing = ours.iter().filter_map(|(name, here)| {
        let there = theirs.get(name).filter(|there| *there != here)?;
        let both = format!("{name} {there}, here {here}");
        Some(if is_short(there) && is_short(here) {
            both
        } else {
            name.clone()
        })
    });
    let differing = differing.collect::<Vec<_>>().join("; ");
    if differing.is_empty() {
        differing
    } else {
        format!(" ({differing})")
    }
}

impl Checkpoint {
    pub fn new(key: String, content: Vec<u8>) -> Self {
        Self {
            key,
            steps: 0,
            history: Vec::new(),
            content,
        }
    }

    /// Reads the checkpoint in a folder; `None` where there is none.
    pub fn load(folder: &Path, key: &str) -> Result<Option<Self>, AttackError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(None);
        }
        files::inputs::own(&path);
        let bytes = files::read(&path)?;
        let parts = bytes.split_at_checked(HASH_LENGTH);
        let whole = parts.filter(|(hash, rest)| files::sha256_hex(rest).as_bytes() == *hash);
        match whole.and_then(|(_, rest)| postcard::from_bytes::<Self>(rest).ok()) {
            None => Err(AttackError::Damaged { path }),
            Some(found) if found.key != key => Err(AttackError::OtherRun {
                which: differences(&found.key, key),
                path,
            }),
            Some(found) => Ok(Some(found)),
        }
    }

    /// Writes the file, unless another run has begun in the folder meanwhile.
    pub fn save(&self, folder: &Path) -> Result<(), AttackError> {
        if let Err(other @ AttackError::OtherRun { .. }) = Self::load(folder, &self.key) {
            return Err(other);
        }
        let rest = postcard::to_allocvec(self)?;
        let mut bytes = files::sha256_hex(&rest).into_bytes();
        bytes.extend(rest);
        Ok(files::replace_atomically(folder, &folder.join(FILE), &bytes)?)
    }
}
