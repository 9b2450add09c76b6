//! What `--json` prints. Every answer is a type whose JSON Schema is in `docs/schema` (`scaleproof schemas`).

use std::fmt::Display;
use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::print::NewFile;
use super::{CommandResult, Outcome, Result};

/// Prints an answer as one line of JSON.
pub(super) fn answer(answer: &impl Serialize, out: &mut dyn Write) -> Result<()> {
    // As a value first: its keys are in alphabetical order.
    Ok(writeln!(out, "{}", serde_json::to_value(answer)?)?)
}

/// Prints an answer: as one line of JSON, or in words.
pub(super) fn told(as_json: bool, facts: impl Serialize, words: impl Display, out: &mut dyn Write) -> CommandResult {
    if as_json {
        answer(&facts, out)?;
    } else {
        writeln!(out, "{words}")?;
    }
    Ok(Outcome::Done)
}

/// What a command that writes files prints.
#[derive(Serialize, JsonSchema)]
pub(super) struct Written<T> {
    /// The paths of what was written.
    files: Vec<String>,
    #[serde(flatten)]
    facts: T,
}

/// One object whose `files` are those that were written.
pub(super) fn written<T>(files: &[NewFile], facts: T) -> Written<T> {
    let files = files.iter().map(|(path, _)| path.display().to_string()).collect();
    Written { files, facts }
}

/// Prints one object whose `files` are those that were written.
pub(super) fn write_json(files: &[NewFile], facts: impl Serialize, out: &mut dyn Write) -> Result<()> {
    answer(&written(files, facts), out)
}
