//! Labels that count as the model: one, or several, such as `car` or `truck`.

use std::fmt;
use std::str::FromStr;

use scaleproof_core::message::{Message, bail, message};
use serde::{Deserialize, Serialize};

/// Maximum number of labels and of their characters; longer lists were written by a program.
const MOST: usize = 32;
const LONGEST: usize = 100;

/// The labels that count as the model, at least one, each once, in alphabetical order. A file has one as a string and several as a list.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, schemars::JsonSchema)]
#[serde(try_from = "Written", into = "Written")]
pub struct Classes(Vec<String>);

#[derive(Deserialize, Serialize, schemars::JsonSchema)]
#[serde(
    untagged,
    expecting = "the class is a label, as in \"car\", or a list of labels, as in [\"car\", \"truck\"]"
)]
enum Written {
    One(String),
    Several(Vec<String>),
}

/// The labels of road vehicles.
pub const VEHICLES: [&str; 3] = ["car", "truck", "bus"];

impl Classes {
    /// Returns true if each of the labels is a road vehicle's.
    pub fn are_vehicles(&self) -> bool {
        self.0.iter().all(|label| VEHICLES.contains(&label.as_str()))
    }

    /// # Errors
    /// An empty list, a label that is listed twice, empty, too long or of characters that nobody reads.
    pub fn new(mut labels: Vec<String>) -> Result<Classes, Message> {
        if labels.is_empty() {
            bail!("the class is an empty list: name the labels that count as the model, as in [\"car\"]");
        }
        if labels.len() > MOST {
            bail!("the class lists {} labels: name at most {MOST}", labels.len());
        }
        if let Some(odd) = labels.iter().find(|label| !is_readable(label)) {
            bail!(
                "the class {:?} is no label: give 1 to {LONGEST} characters without line breaks",
                odd.chars().take(LONGEST).collect::<String>()
            );
        }
        labels.sort();
        match labels.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(message!(
                "the class lists `{}` twice: name each label once",
                pair[0].clone()
            )),
            None => Ok(Classes(labels)),
        }
    }

    /// Returns the labels, in alphabetical order.
    pub fn labels(&self) -> &[String] {
        &self.0
    }

    /// Returns one name for all of them, as in `car+truck`: the name of the category in a COCO file.
    pub fn joined(&self) -> String {
        self.0.join("+")
    }

    /// Returns the labels as in a sentence about them: "`car` or `truck`".
    pub fn quoted(&self) -> String {
        let quoted: Vec<String> = self.0.iter().map(|label| format!("`{label}`")).collect();
        or(&quoted)
    }

    /// Returns the labels in the syntax of `scene.toml`.
    pub fn to_toml(&self) -> String {
        match &self.0[..] {
            [only] => toml::Value::from(only.as_str()),
            several => toml::Value::from(several.to_vec()),
        }
        .to_string()
    }
}

fn is_readable(label: &str) -> bool {
    let is_short = (1..=LONGEST).contains(&label.chars().count());
    is_short && label.trim() == label && !label.contains(char::is_control)
}

/// Joins labels as in "car", "car or truck", "bus, car or truck".
fn or(labels: &[String]) -> String {
    match labels {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => labels.concat(),
    }
}

impl fmt::Display for Classes {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&or(&self.0))
    }
}

/// Parses a list separated by commas, as given to a command's option.
impl FromStr for Classes {
    type Err = Message;

    fn from_str(text: &str) -> Result<Classes, Message> {
        Classes::new(text.split(',').map(|label| label.trim().to_owned()).collect())
    }
}

impl TryFrom<Written> for Classes {
    type Error = Message;

    fn try_from(written: Written) -> Result<Classes, Message> {
        match written {
            Written::One(label) => Classes::new(vec![label]),
            Written::Several(labels) => Classes::new(labels),
        }
    }
}

impl From<Classes> for Written {
    fn from(Classes(mut labels): Classes) -> Written {
        if labels.len() == 1 {
            Written::One(labels.remove(0))
        } else {
            Written::Several(labels)
        }
    }
}
