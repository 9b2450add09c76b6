//! `scaleproof attack`: frames, the models that predict them, and patterns against detectors.

use std::path::{Path, PathBuf};

use scaleproof_frames::LIST;
use scaleproof_gradients::WhiteBox;

/// Detectors, and the name and hash of each.
pub type WhiteBoxes = (Vec<Box<dyn WhiteBox>>, Vec<String>);

/// Returns the path of the list of frames in a folder that has none yet.
pub fn new_list(folder: &Path) -> Result<PathBuf, String> {
    let list = folder.join(LIST);
    if list.exists() {
        Err(format!("{} is there already; give another folder", list.display()))
    } else {
        Ok(list)
    }
}
