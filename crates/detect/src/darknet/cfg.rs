//! Darknet's `.cfg`: sections `[kind]` with lines `key=value`; `#` and `;` begin comments.

use std::collections::BTreeMap;
use std::str::FromStr;

#[derive(Debug, Default, PartialEq)]
pub(super) struct Section {
    pub kind: String,
    /// Its line in the file, from 1.
    pub line: usize,
    settings: BTreeMap<String, String>,
}

impl Section {
    /// All sections of a file; the error has its line.
    pub(super) fn read(text: &str) -> Result<Vec<Section>, (usize, String)> {
        let mut sections: Vec<Section> = Vec::new();
        for (i, line) in text.lines().enumerate() {
            let line = line
                .trim_start_matches('\u{feff}')
                .split(['#', ';'])
                .next()
                .unwrap_or_default()
                .trim();
            let number = i + 1;
            if let Some(kind) = line.strip_prefix('[') {
                let kind = kind.trim_end_matches(']').trim().to_lowercase();
                sections.push(Section {
                    kind,
                    line: number,
                    settings: BTreeMap::new(),
                });
            } else if !line.is_empty() {
                let pair = line.split_once('=').zip(sections.last_mut());
                let Some(((key, value), section)) = pair else {
                    return Err((
                        number,
                        format!("{line:?} is neither a [section] nor key=value within one"),
                    ));
                };
                // Of a key that is there twice Darknet takes the first (its `option_find`).
                let setting = section.settings.entry(key.trim().to_owned());
                setting.or_insert_with(|| value.trim().to_owned());
            }
        }
        Ok(sections)
    }

    /// A setting, if it is there.
    pub(super) fn text(&self, key: &str) -> Option<&str> {
        self.settings.get(key).map(String::as_str)
    }

    /// A number, or what Darknet takes where it is not there.
    pub(super) fn number<T: FromStr>(&self, key: &str, otherwise: T) -> Result<T, String> {
        self.text(key).map_or(Ok(otherwise), |text| parsed(self, key, text))
    }

    /// Numbers with commas between them.
    pub(super) fn numbers<T: FromStr>(&self, key: &str) -> Result<Vec<T>, String> {
        let text = self.text(key).unwrap_or_default();
        let parts = text.split(',').map(str::trim).filter(|part| !part.is_empty());
        parts.map(|part| parsed(self, key, part)).collect()
    }

    /// Refuses a setting that changes what a layer computes and is not read here.
    pub(super) fn refuse(&self, keys: &[&str]) -> Result<(), String> {
        let set = |key: &&&str| self.text(key).is_some_and(|v| v != "0" && v != "none");
        match keys.iter().find(set) {
            Some(key) => Err(format!(
                "[{}] has {key}={}, which is not read here: convert the network to ONNX with another program",
                self.kind,
                self.text(key).unwrap_or_default()
            )),
            None => Ok(()),
        }
    }
}

fn parsed<T: FromStr>(section: &Section, key: &str, text: &str) -> Result<T, String> {
    text.parse()
        .map_err(|_| format!("[{}] has {key}={text}: give a number", section.kind))
}
