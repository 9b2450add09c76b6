//! What a resumed run needs, in one file; floats come back bit for bit. The file begins with the SHA-256 of the rest, as hex: a damaged one would
//! go on to another pattern.

use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::RunError;
use super::history::Entry;
use scaleproof_core::files;

pub const FILE: &str = "checkpoint";
/// Between two of them.
pub const AT_MOST: Duration = Duration::from_secs(20);

/// Hexadecimal digits of a SHA-256.
const HASH_LENGTH: usize = 64;

/// The content of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// SHA-256 of what the run depends on.
    key: String,
    /// Steps done.
    pub steps: u32,
    pub history: Vec<Entry>,
    /// What the method keeps besides.
    pub content: Vec<u8>,
}

/// The SHA-256 of what a run depends on.
///
/// # Errors
/// Only if the encoder fails.
pub fn key(settings: &impl Serialize) -> Result<String, RunError> {
    Ok(files::sha256_hex(&serde_json::to_vec(settings)?))
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
    pub fn load(folder: &Path, key: &str) -> Result<Option<Self>, RunError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(None);
        }
        files::inputs::own(&path);
        let bytes = files::read(&path)?;
        let parts = bytes.split_at_checked(HASH_LENGTH);
        let whole = parts.filter(|(hash, rest)| files::sha256_hex(rest).as_bytes() == *hash);
        match whole.and_then(|(_, rest)| postcard::from_bytes::<Self>(rest).ok()) {
            None => Err(RunError::Damaged { path }),
            Some(found) if found.key != key => Err(RunError::OtherRun { path }),
            Some(found) => Ok(Some(found)),
        }
    }

    /// Whole or not at all. Another run may have begun in the folder meanwhile, and its checkpoint is not taken from it.
    pub fn save(&self, folder: &Path) -> Result<(), RunError> {
        if let Err(other @ RunError::OtherRun { .. }) = Self::load(folder, &self.key) {
            return Err(other);
        }
        let rest = postcard::to_allocvec(self)?;
        let mut bytes = files::sha256_hex(&rest).into_bytes();
        bytes.extend(rest);
        Ok(files::replace_atomically(&folder.join(FILE), &bytes)?)
    }
}
