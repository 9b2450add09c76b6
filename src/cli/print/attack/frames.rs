//! Frames that were written or checked, as JSON and in words.

use std::io::Write;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::CommandResult;
use crate::cli::answer::told;
use scaleproof_core::spelling::count;

/// `attack render --json`, `attack import --json` and `attack colours --json`.
#[derive(Serialize, JsonSchema)]
pub struct WrittenFrames {
    /// The path of `frames.json`.
    pub file: PathBuf,
    /// How many frames it lists.
    pub frames: usize,
}

/// `attack check --json`.
#[derive(Serialize, JsonSchema)]
pub struct CheckedFrames {
    /// How many there are, all whole.
    pub frames: usize,
    /// Their width and height.
    pub size_px: [u32; 2],
}

/// Prints the result of a command that wrote frames.
pub fn say_frames(list: &Path, frames: usize, json: bool, out: &mut dyn Write) -> CommandResult {
    let words = format!("{}: {}", list.display(), count(frames, "frame"));
    let file = list.to_owned();
    told(json, WrittenFrames { file, frames }, words, out)
}
