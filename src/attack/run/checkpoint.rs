//! What a run that goes on needs, in one file; floats come back bit for bit.

use std::path::Path;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::history::Entry;
use super::{RunError, encode};
use crate::files;

/// Its name in the folder of the run.
pub const FILE: &str = "checkpoint";
/// Between two of them.
pub const AT_MOST: Duration = Duration::from_secs(20);

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
    let text = serde_json::to_string(settings).map_err(|e| RunError::Encode { reason: e.to_string() })?;
    Ok(files::sha256_hex(text.as_bytes()))
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
    ///
    /// # Errors
    /// One that is damaged, or of another run.
    pub fn load(folder: &Path, key: &str) -> Result<Option<Self>, RunError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(None);
        }
        let found: Result<Self, _> = postcard::from_bytes(&files::read(&path)?);
        match found {
            Err(_) => Err(RunError::Damaged { path }),
            Ok(found) if found.key != key => Err(RunError::OtherRun { path }),
            Ok(found) => Ok(Some(found)),
        }
    }

    /// Whole or not at all.
    ///
    /// # Errors
    /// A folder that takes no files.
    pub fn save(&self, folder: &Path) -> Result<(), RunError> {
        let bytes = postcard::to_allocvec(self).map_err(encode)?;
        Ok(files::write_atomically(&folder.join(FILE), &bytes)?)
    }
}
