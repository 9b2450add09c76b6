//! What a resumed run needs, in one file; floats come back bit for bit. The file begins with the SHA-256 of the rest, as hex: a damaged one would
//! go on to another pattern.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::history::Entry;
use crate::AttackError;
use scaleproof_core::files;

pub const FILE: &str = "checkpoint";
/// Between two of them.
pub const AT_MOST: Duration = Duration::from_secs(20);

/// Hexadecimal digits of a SHA-256.
const HASH_LENGTH: usize = 64;

/// The content of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// What the run depends on.
    key: String,
    /// Steps done.
    pub steps: u32,
    pub history: Vec<Entry>,
    /// What the method keeps besides.
    pub content: Vec<u8>,
}

/// A longer value is known by its SHA-256.
const LONGEST_VALUE: usize = 60;

/// What a run depends on, as JSON: each setting with its value.
///
/// # Errors
/// Only if the encoder fails.
pub fn key(settings: &impl Serialize) -> Result<String, AttackError> {
    let settings: BTreeMap<String, Value> = serde_json::from_value(serde_json::to_value(settings)?)?;
    let short = |value: Value| match value.to_string() {
        text if text.len() > LONGEST_VALUE => files::sha256_hex(text.as_bytes()),
        text => text,
    };
    let short: BTreeMap<_, _> = settings.into_iter().map(|(name, value)| (name, short(value))).collect();
    Ok(serde_json::to_string(&short)?)
}

/// Which settings of two runs differ, in brackets: `(batch 2, here 4; detectors)`. Nothing for a checkpoint of another version, which says less.
fn which(theirs: &str, ours: &str) -> String {
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

    /// The checkpoint in a folder; `None` where there is none.
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
                which: which(&found.key, key),
                path,
            }),
            Some(found) => Ok(Some(found)),
        }
    }

    /// Whole or not at all. Another run may have begun in the folder meanwhile, and its checkpoint is not taken from it.
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
