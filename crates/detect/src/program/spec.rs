//! The start of a program: a command line, or a manifest with `command`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::super::Manifest;
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, message};

/// Prefix of a detector's name that is a command line.
const PREFIX: &str = "exec:";

/// A program, and what a manifest says of it.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramSpec {
    /// The program and its arguments.
    pub command: Vec<String>,
    /// Name here, in place of the one that it gives itself; so are the next three.
    pub name: Option<String>,
    pub title: Option<String>,
    pub licence: Option<String>,
    pub origin: Option<String>,
    /// Labels that count as others: own label → label of the scene.
    #[serde(default)]
    pub class_map: BTreeMap<String, String>,
    /// Folder that it is started in: the manifest's.
    #[serde(skip)]
    pub folder: Option<PathBuf>,
}

impl ProgramSpec {
    /// The program that a detector's name means: `exec:` and a command line, or a manifest with `command`. `None` for any other name.
    pub fn named(name: &str) -> Result<Option<ProgramSpec>, Message> {
        if let Some(line) = name.strip_prefix(PREFIX) {
            let command = words(line).and_then(|words| match words.first() {
                Some(program) if !program.is_empty() => Ok(words),
                _ => Err("no program is named: write exec:PROGRAM, or exec:'PROGRAM ARGUMENT …'"),
            });
            let command = command.map_err(|fault| message!("{name}: {fault}"))?;
            return Ok(Some(ProgramSpec {
                command,
                ..ProgramSpec::default()
            }));
        }
        let path = Path::new(name);
        if !name.ends_with(".toml") || !path.is_file() {
            return Ok(None);
        }
        let text = files::read_text(path)?;
        let has_command = toml::from_str::<toml::Table>(&text).is_ok_and(|table| table.contains_key("command"));
        Ok(has_command.then(|| ProgramSpec::parse(&text, path)).transpose()?)
    }

    /// A manifest's text; `path` is where it lies.
    pub fn parse(text: &str, path: &Path) -> Result<ProgramSpec, FileError> {
        let refuse = |message: &str| {
            let message = message.replace('\n', " ");
            FileError::content(path, format!("the manifest is not valid: {message}"))
        };
        let spec: ProgramSpec = toml::from_str(text).map_err(|e| refuse(e.message()))?;
        if spec.command.first().is_none_or(String::is_empty) {
            return Err(refuse(
                "command is empty: give the program and its arguments, [\"python3\", \"mine.py\"]",
            ));
        }
        if spec.name.as_ref().is_some_and(|name| !Manifest::is_name(name)) {
            return Err(refuse(
                "use letters, digits, `_`, `-` and `.` for the name, as files are named by it",
            ));
        }
        Ok(ProgramSpec {
            folder: path.parent().map(Path::to_owned),
            ..spec
        })
    }

    pub fn in_words(&self) -> String {
        self.command.join(" ")
    }

    /// Returns how the first word is started, where it is a file that does not start by itself.
    pub(super) fn instead(&self) -> String {
        let Some(file) = self.command.first().filter(|word| self.seen(Path::new(word)).is_file()) else {
            return String::new();
        };
        match interpreter(file) {
            Some(interpreter) => format!("; write `{interpreter} {}`", self.in_words()),
            None if file.contains('/') => format!("; is {file} made executable (chmod +x)?"),
            None => format!("; write `./{}`, for a program in this folder", self.in_words()),
        }
    }

    /// The files among its words, as a script behind its interpreter.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let named = self.command.iter().map(|word| self.seen(Path::new(word)));
        named.filter(|path| path.is_file()).collect()
    }

    pub(super) fn seen(&self, path: &Path) -> PathBuf {
        self.folder.as_ref().map_or(path.to_owned(), |folder| folder.join(path))
    }
}

pub(crate) fn interpreter(file: &str) -> Option<&'static str> {
    match Path::new(file).extension()?.to_str()? {
        "py" => Some("python3"),
        "sh" => Some("sh"),
        _ => None,
    }
}

/// The words of a command line: blanks part them, except between quotes.
fn words(line: &str) -> Result<Vec<String>, &'static str> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (quote, c) {
            (None, '"' | '\'') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (Some(open), c) if c == open => quote = None,
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            (_, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    match quote {
        None => Ok(words),
        Some(_) => Err("a quotation mark has no second"),
    }
}
