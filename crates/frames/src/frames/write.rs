//! Writing `frames.json`.

use std::path::PathBuf;

use super::{FrameList, FramesError, LIST};

impl FrameList {
    /// The list as a file of the folder, to be written after the images it names.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_file(&self, folder: &std::path::Path) -> Result<(PathBuf, Vec<u8>), FramesError> {
        let mut text = serde_json::to_string_pretty(self).map_err(|e| FramesError::Encode { reason: e.to_string() })?;
        text.push('\n');
        Ok((folder.join(LIST), text.into_bytes()))
    }
}
