//! What a program says of itself in its first line.

use std::path::PathBuf;

use serde::Deserialize;

use super::super::{Labels, Manifest};
use super::answer::one_line;

/// The protocol's version, which a hello states.
const VERSION: u32 = 1;
/// No text of a hello is longer, in characters.
const LONGEST_TEXT: usize = 1000;
const MOST_FILES: usize = 1000;
const MOST_WORKERS: usize = 1024;

/// What a program is, and how it is fed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Hello {
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
    /// Whether the same photo always gets the same answer, so that answers may be kept.
    #[serde(default)]
    pub deterministic: bool,
    /// Whether it gives the loss of an image and its derivative by each pixel, too.
    #[serde(default)]
    pub gradients: Gradients,
    /// So many may run side by side.
    #[serde(default = "one")]
    pub workers: usize,
    pub title: Option<String>,
    pub licence: Option<String>,
    pub origin: Option<String>,
}

fn one() -> usize {
    1
}

/// What of the derivative of its loss a program gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "GradientsKey")]
pub enum Gradients {
    #[default]
    Nothing,
    Whole,
    /// What the program leaves out on purpose is missing, as in detectors of two stages the way through the proposals.
    Partial,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "gradients is true, false or \"partial\"")]
enum GradientsKey {
    Given(bool),
    Word(String),
}

impl TryFrom<GradientsKey> for Gradients {
    type Error = &'static str;

    fn try_from(key: GradientsKey) -> Result<Gradients, Self::Error> {
        match key {
            GradientsKey::Given(false) => Ok(Gradients::Nothing),
            GradientsKey::Given(true) => Ok(Gradients::Whole),
            GradientsKey::Word(word) if word == "partial" => Ok(Gradients::Partial),
            GradientsKey::Word(_) => Err("gradients is true, false or \"partial\""),
        }
    }
}

/// How a photo is handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum InputRule {
    /// The file's path: the program decodes it, and turns it as its EXIF says.
    Path,
    /// Its upright pixels: rows of red, green and blue bytes.
    Rgb,
}

impl Hello {
    /// Reads a first line.
    ///
    /// # Errors
    /// What is wrong with it, as the end of a sentence.
    pub(super) fn parse(line: &str) -> Result<Hello, String> {
        // The fault may quote what the program says.
        Hello::read(line).map_err(|fault| one_line(&fault))
    }

    fn read(line: &str) -> Result<Hello, String> {
        if !line.trim_start().starts_with('{') {
            let start: String = line.trim().chars().take(60).collect();
            return Err(format!(
                "its first line is {start:?} and not its hello: whatever else it prints belongs on standard error"
            ));
        }
        let hello: Hello = serde_json::from_str(line).map_err(|e| format!("its hello is not valid: {e}"))?;
        hello
            .check()
            .map_err(|fault| format!("its hello is not valid: {fault}"))?;
        Ok(hello)
    }

    fn check(&self) -> Result<(), String> {
        let version = self.scaleproof_detector;
        if version != VERSION {
            return Err(format!(
                "it speaks version {version} of the protocol, and this program version {VERSION}"
            ));
        }
        if !Manifest::is_name(&self.name) {
            let name = &self.name;
            return Err(format!("name is {name:?}: use letters, digits, `_`, `-` and `.`"));
        }
        let texts = [
            Some(&self.name),
            Some(&self.version),
            self.title.as_ref(),
            self.licence.as_ref(),
            self.origin.as_ref(),
        ];
        let is_long = |text: &&String| text.chars().count() > LONGEST_TEXT || text.contains(char::is_control);
        if let Some(text) = texts.into_iter().flatten().find(is_long) {
            let start: String = text.chars().take(40).collect();
            return Err(format!(
                "the text {start:?} has control characters or more than {LONGEST_TEXT} characters"
            ));
        }
        if self.files.len() > MOST_FILES {
            return Err(format!("it has more than {MOST_FILES} files"));
        }
        if self.gradients != Gradients::Nothing && self.input != InputRule::Rgb {
            return Err("gradients need pixels: its input must be \"rgb\"".to_owned());
        }
        if (1..=MOST_WORKERS).contains(&self.workers) {
            Ok(())
        } else {
            Err(format!(
                "workers is {}: give a number from 1 to {MOST_WORKERS}",
                self.workers
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hello(change: &str) -> Result<Hello, String> {
        let usual =
            r#"{"scaleproof_detector": 1, "name": "mine", "version": "1.0", "labels": "coco80", "input": "rgb"}"#;
        Hello::parse(&usual.replace("\"name\": \"mine\"", change))
    }

    #[test]
    fn a_hello_says_what_is_needed_and_nothing_else() {
        let usual = hello(r#""name": "mine""#).unwrap();
        assert_eq!(
            (usual.workers, usual.deterministic, usual.input),
            (1, false, InputRule::Rgb)
        );
        for (change, words) in [
            (r#""name": "my car""#, "name is \"my car\""),
            (r#""nam": "mine""#, "unknown field `nam`"),
            (r#""name": "mine", "workers": 0"#, "workers is 0"),
            (r#""name": "mine", "title": "a\nb""#, "control characters"),
            (
                r#""name": "mine", "gradients": "some""#,
                "gradients is true, false or \"partial\"",
            ),
        ] {
            let error = hello(change).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        assert!(
            Hello::parse("Loading weights…")
                .unwrap_err()
                .contains("\"Loading weights…\" and not its hello")
        );
        let long = "x".repeat(1 << 20);
        for change in [
            format!(r#""name": "{long}""#),
            format!(r#""name": "mine", "{long}": 1"#),
            format!(r#""name": "mine", "gradients": "{long}""#),
        ] {
            assert!(hello(&change).unwrap_err().len() < 1000);
        }
        let other = r#"{"scaleproof_detector": 2, "name": "mine", "version": "", "labels": ["a"], "input": "path"}"#;
        assert!(Hello::parse(other).unwrap_err().contains("version 2"));
    }
}
