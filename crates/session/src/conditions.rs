//! Conditions of a photo without a field of their own: the weather, the light, a simulator's angles. Stored as texts, for grouping.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer};
use serde_json::Value;

/// Names and values, as `weather` and `rain`.
pub type Conditions = BTreeMap<String, String>;

/// Maximum length of a condition's name.
const LONGEST_NAME: usize = 40;

/// Returns true for a valid name of a condition, which can be given on a command line.
pub fn is_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_alphanumeric() || "_-. ".contains(c);
    (1..=LONGEST_NAME).contains(&name.chars().count()) && name.trim() == name && name.chars().all(is_plain)
}

/// Converts a text, a number or a truth value to text; `None` for lists, objects and empty texts.
pub fn scalar(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.trim().to_owned()),
        Value::Number(number) => Some(number.to_string()),
        Value::Bool(is_so) => Some(is_so.to_string()),
        _ => None,
    }
    .filter(|text| !text.is_empty() && !text.chars().any(char::is_control))
}

/// Reads the `conditions` of a `session.json`, whose values may be texts, numbers and truth values.
pub fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Conditions, D::Error> {
    let mut conditions = Conditions::new();
    for (name, value) in BTreeMap::<String, Value>::deserialize(from)? {
        let text = scalar(&value).ok_or_else(|| {
            serde::de::Error::custom(format!("the condition `{name}` is {value}: give a text or a number"))
        })?;
        conditions.insert(name, text);
    }
    Ok(conditions)
}
