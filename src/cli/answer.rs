//! Answers of `--json`. Every answer is a type whose JSON Schema is in `docs/schema` (`scaleproof schemas`).

use std::fmt::Display;
use std::io::Write;
use std::path::PathBuf;

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::Serialize;

use super::{CommandResult, Outcome, Result};

/// The name of an output, and its schema.
pub(super) type Named = (&'static str, Schema);

/// An output's name with the schema of what is written of its type: keys that may be left out are not required.
pub(super) fn named<T: JsonSchema>(name: &'static str) -> Named {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    (name, settings.into_generator().into_root_schema_for::<T>())
}

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
pub(super) fn written<T>(files: &[(PathBuf, Vec<u8>)], facts: T) -> Written<T> {
    let files = files.iter().map(|(path, _)| path.display().to_string()).collect();
    Written { files, facts }
}
