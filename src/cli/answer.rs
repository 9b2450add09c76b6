//! What `--json` prints. Every answer is a type whose JSON Schema is in `docs/schema` (`scaleproof schemas`).

use std::io::Write;
use std::path::PathBuf;

use schemars::{JsonSchema, Schema};
use serde::Serialize;

use super::Result;

/// The name of an output, and its schema.
pub(super) type Named = (&'static str, Schema);

/// Prints an answer as one line of JSON.
pub(super) fn answer(answer: &impl Serialize, out: &mut dyn Write) -> Result<()> {
    // As a value first: its keys are in alphabetical order.
    Ok(writeln!(out, "{}", serde_json::to_value(answer)?)?)
}

/// What a command that writes files prints.
#[derive(Serialize, JsonSchema)]
pub(super) struct Written<T> {
    /// The paths of what was written.
    files: Vec<String>,
    #[serde(flatten)]
    facts: T,
}

/// Prints one object whose `files` are those that were written.
pub(super) fn write_json(files: &[(PathBuf, Vec<u8>)], facts: impl Serialize, out: &mut dyn Write) -> Result<()> {
    let files = files.iter().map(|(path, _)| path.display().to_string()).collect();
    answer(&Written { files, facts }, out)
}
