//! The hello of a program, its first line.

use std::path::PathBuf;

use serde::Deserialize;

use super::super::{Labels, Manifest};
use super::answer::{one_line, start};

/// The protocol's version, which a hello states.
const VERSION: u32 = 1;
/// No text of a hello is longer, in characters.
const LONGEST_TEXT: usize = 1000;
const MOST_FILES: usize = 1000;
const MOST_WORKERS: usize = 1024;

/// The first line of a program: what it is, and its input.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    /// Version of the protocol.
    scaleproof_detector: u32,
    pub name: String,
    /// The program's own line about itself: versions, weights, settings.
    pub version: String,
    pub labels: Labels,
    pub input: InputRule,
    /// Files that its answers depend on.
    #[serde(default)]
    pub files: Vec<PathBuf>,
    /// True where the same photo always gets the same answer, so that answers may be kept.
    #[serde(default)]
    pub deterministic: bool,
    /// The gradients that it gives: the loss of an image and its derivative by each pixel.
    #[serde(default)]
    pub gradients: Gradients,
    /// Most processes of it that may run side by side.
    #[serde(default = "one")]
    pub workers: usize,
    pub title: Option<String>,
    pub licence: Option<String>,
    pub origin: Option<String>,
}

/// The first line of a program that changes images.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DefenceHello {
    /// Version of the protocol.
    scaleproof_defence: u32,
    name: String,
    version: String,
    #[serde(default)]
    files: Vec<PathBuf>,
    #[serde(default)]
    deterministic: bool,
    #[serde(default = "one")]
    workers: usize,
}

impl DefenceHello {
    fn into_hello(self) -> Hello {
        Hello {
            scaleproof_detector: self.scaleproof_defence,
            name: self.name,
            version: self.version,
            labels: Labels::Coco80,
            input: InputRule::Rgb,
            files: self.files,
            deterministic: self.deterministic,
            gradients: Gradients::Nothing,
            workers: self.workers,
            title: None,
            licence: None,
            origin: None,
        }
    }
}

fn one() -> usize {
    1
}

/// The part of its loss's derivative that a program gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "serde_json::Value")]
pub enum Gradients {
    #[default]
    Nothing,
    Whole,
    /// All but a part that the program leaves out on purpose, as in detectors of two stages the way through the proposals.
    Partial,
}

impl TryFrom<serde_json::Value> for Gradients {
    type Error = &'static str;

    fn try_from(key: serde_json::Value) -> Result<Gradients, Self::Error> {
        match (key.as_bool(), key.as_str()) {
            (Some(false), _) => Ok(Gradients::Nothing),
            (Some(true), _) => Ok(Gradients::Whole),
            (_, Some("partial")) => Ok(Gradients::Partial),
            _ => Err("gradients is true, false or \"partial\""),
        }
    }
}

/// The form in which a photo is handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputRule {
    /// The file's path: the program decodes it, and turns it as its EXIF says.
    Path,
    /// Its upright pixels: rows of red, green and blue bytes.
    Rgb,
}

impl Hello {
    /// Reads a first line.
    ///
    /// # Errors
    /// A fault of the line, as the end of a sentence.
    pub fn parse(line: &str) -> Result<Hello, String> {
        Self::parse_as(line, |line| serde_json::from_str(line))
    }

    /// Reads the first line of a program that is a defence, which has no labels and takes pixels.
    ///
    /// # Errors
    /// A fault of the line, as the end of a sentence.
    pub fn parse_of_defence(line: &str) -> Result<Hello, String> {
        Self::parse_as(line, |line| serde_json::from_str(line).map(DefenceHello::into_hello))
    }

    fn parse_as(line: &str, read: fn(&str) -> serde_json::Result<Hello>) -> Result<Hello, String> {
        if !line.trim_start().starts_with('{') {
            return Err(one_line(&format!(
                "its first line is {:?} and not its hello: whatever else it prints belongs on standard error",
                start(line.trim())
            )));
        }
        let read = read(line).map_err(|e| e.to_string());
        let checked = read.and_then(|hello| hello.fault().map_or(Ok(hello), Err));
        // The fault may quote what the program says.
        checked.map_err(|fault| one_line(&format!("its hello is not valid: {fault}")))
    }

    fn fault(&self) -> Option<String> {
        let (version, name, workers) = (self.scaleproof_detector, &self.name, self.workers);
        if version != VERSION {
            return Some(format!(
                "it speaks version {version} of the protocol, and this program version {VERSION}"
            ));
        }
        if !Manifest::is_name(name) {
            return Some(format!("name is {name:?}: use letters, digits, `_`, `-` and `.`"));
        }
        let texts = [name, &self.version].into_iter();
        let mut texts = texts.chain(&self.title).chain(&self.licence).chain(&self.origin);
        if let Some(text) = texts.find(|text| text.chars().count() > LONGEST_TEXT || text.contains(char::is_control)) {
            let start: String = text.chars().take(40).collect();
            return Some(format!(
                "the text {start:?} has control characters or more than {LONGEST_TEXT} characters"
            ));
        }
        if self.files.len() > MOST_FILES {
            return Some(format!("it has more than {MOST_FILES} files"));
        }
        if self.gradients != Gradients::Nothing && self.input != InputRule::Rgb {
            return Some("gradients need pixels: its input must be \"rgb\"".to_owned());
        }
        let is_good = (1..=MOST_WORKERS).contains(&workers);
        (!is_good).then(|| format!("workers is {workers}: give a number from 1 to {MOST_WORKERS}"))
    }
}
