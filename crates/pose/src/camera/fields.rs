//! Named values of a camera file in any notation: YAML, JSON (which is YAML too), or OpenCV's XML.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::yaml;
use scaleproof_core::message::{Message, bail, message};

/// Value in a file.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
pub(super) enum Value {
    Number(f64),
    Text(String),
    List(Vec<Value>),
    Map(BTreeMap<String, Value>),
    Other(IgnoredAny),
}

/// Values by name, and the description of the file that error messages use.
pub(super) struct Fields {
    what: &'static str,
    values: BTreeMap<String, Value>,
}

/// Normalises a name for comparison: lower case, without `_` and `-`, since writers differ in these.
fn plain(name: &str) -> String {
    name.to_lowercase().replace(['_', '-'], "")
}

impl Fields {
    pub(super) fn new(what: &'static str, values: BTreeMap<String, Value>) -> Fields {
        Fields { what, values }
    }

    /// Returns the names and values of a YAML or JSON text; no fields if the text is not a table.
    pub(super) fn of_yaml(text: &str) -> Result<Fields, Message> {
        let what = "a camera file";
        if text.contains("!!python/object") {
            let reason = "it holds objects of Python instead of numbers: dump lists, as camera_matrix.tolist()";
            bail!("not {what}: {reason}");
        }
        let values = match yaml::parse(text, what)? {
            Value::Map(values) => values,
            _ => BTreeMap::new(),
        };
        Ok(Fields { what, values })
    }

    /// Returns the fields with another description of the file for error messages.
    pub(super) fn called(self, what: &'static str) -> Fields {
        Fields { what, ..self }
    }

    /// Returns the nested tables that have at least one of the given names, with the tables' own names.
    pub(super) fn tables_with(self, names: &[&str]) -> Vec<(String, Fields)> {
        let what = self.what;
        let tables = self.values.into_iter().filter_map(|(name, value)| match value {
            Value::Map(values) => Some((name, Fields { what, values })),
            _ => None,
        });
        tables.filter(|(_, table)| table.find(names).is_some()).collect()
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.find(&[name]).is_some()
    }

    /// Returns the first of the given names that is present, as the file spells it, and its value.
    fn find(&self, names: &[&str]) -> Option<(&str, &Value)> {
        let is = |name: &str| self.values.iter().find(|(own, _)| plain(own) == plain(name));
        let (name, value) = names.iter().find_map(|name| is(name))?;
        Some((name, value))
    }

    /// Returns an error that refuses the file for this reason.
    pub(super) fn refuse(&self, reason: String) -> Message {
        let what = self.what;
        message!("not {what}: {reason}")
    }

    /// Returns the number under the first of the given names that is present; `None` if none is.
    pub(super) fn number(&self, names: &[&str]) -> Result<Option<f64>, Message> {
        let Some((name, value)) = self.find(names) else {
            return Ok(None);
        };
        let number = number(value).ok_or_else(|| self.refuse(format!("{name} is no number")));
        number.map(Some)
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        match self.find(&[name])?.1 {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Returns the numbers under the first of the given names that is present: a list, nested lists, or a matrix of OpenCV or ROS with its shape.
    pub(super) fn numbers(&self, names: &[&str]) -> Result<Option<Vec<f64>>, Message> {
        let Some((name, value)) = self.find(names) else {
            return Ok(None);
        };
        let (data, shape) = match value {
            Value::Map(matrix) => (matrix.get("data"), shape(matrix)),
            list => (Some(list), None),
        };
        let mut all = Vec::new();
        if !data.is_some_and(|data| flat(data, &mut all)) {
            return Err(self.refuse(format!("{name} is no list of numbers")));
        }
        match shape {
            Some([rows, cols]) if rows * cols != all.len() as f64 => Err(message!(
                "{name} says {rows} × {cols} but has {found} numbers",
                found = all.len()
            )),
            _ => Ok(Some(all)),
        }
    }

    /// Returns width and height of the image in pixels, under any of their usual names.
    pub(super) fn size(&self) -> Result<[u32; 2], Message> {
        if let Some(size) = self.numbers(&["resolution", "image_size", "img_size"])? {
            let [width, height] = size[..] else {
                return Err(self.refuse(format!(
                    "the image's size has {} numbers: give width and height",
                    size.len()
                )));
            };
            return Ok([self.whole("width", width)?, self.whole("height", height)?]);
        }
        let side = |names: &[&str]| {
            let missing = || {
                self.refuse(
                    "it does not say how large the image is: add image_width and image_height, in pixels".into(),
                )
            };
            self.whole(names[0], self.number(names)?.ok_or_else(missing)?)
        };
        Ok([
            side(&["image_width", "width", "w"])?,
            side(&["image_height", "height", "h"])?,
        ])
    }

    fn whole(&self, name: &str, number: f64) -> Result<u32, Message> {
        let is_whole = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
        let fault = || self.refuse(format!("{name} is {number}: give whole pixels"));
        is_whole.then_some(number as u32).ok_or_else(fault)
    }
}

/// Returns rows and columns of a matrix: `rows` and `cols`, or 1 and the product of OpenCV 5's `sizes`.
fn shape(matrix: &BTreeMap<String, Value>) -> Option<[f64; 2]> {
    let side = |name: &str| matrix.get(name).and_then(number);
    if let Some(sizes) = matrix.get("sizes") {
        let mut all = Vec::new();
        return flat(sizes, &mut all).then(|| [1.0, all.iter().product()]);
    }
    Some([side("rows")?, side("cols")?])
}

/// Parses a number: YAML's own, or text such as OpenCV's `1180.`.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(number) => Some(*number),
        Value::Text(text) => text.trim().parse().ok(),
        _ => None,
    }
}

/// Appends all numbers of a value, row by row; returns false if it contains anything else.
fn flat(value: &Value, to: &mut Vec<f64>) -> bool {
    match value {
        Value::List(list) => list.iter().all(|value| flat(value, to)),
        value => number(value).map(|number| to.push(number)).is_some(),
    }
}
