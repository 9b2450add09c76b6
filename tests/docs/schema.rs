//! Just enough of JSON Schema (draft 2020-12) to hold a file against what `scaleproof schemas` writes. Stricter in one point: an object has no
//! keys but those of its schema.

use std::path::Path;

use serde_json::Value;

/// What a JSON file, or one of a JSON object a line, says against its schema.
pub fn faults(file: &Path, schema: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let values: Vec<Value> = match serde_json::from_str(&text) {
        Ok(whole) => vec![whole],
        Err(_) => text.lines().map(|line| serde_json::from_str(line).unwrap()).collect(),
    };
    assert!(!values.is_empty(), "{} is empty", file.display());
    let root = crate::common::read_json(schema);
    values.iter().flat_map(|value| check(&root, &root, value, "")).collect()
}

/// The schemas that hold for a value beside each other: references followed, and of alternatives the first that fits.
fn parts<'a>(root: &'a Value, schema: &'a Value, value: &Value) -> Option<Vec<&'a Value>> {
    let mut all = vec![schema];
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.strip_prefix('#')?)?;
        all.extend(parts(root, target, value)?);
    }
    for part in schema["allOf"].as_array().into_iter().flatten() {
        all.extend(parts(root, part, value)?);
    }
    for alternatives in ["anyOf", "oneOf"] {
        if let Some(alternatives) = schema[alternatives].as_array() {
            let fits = |part: &&Value| {
                check(root, part, value, "")
                    .iter()
                    .all(|fault| fault.starts_with(UNKNOWN))
            };
            all.extend(parts(root, alternatives.iter().find(fits)?, value)?);
        }
    }
    Some(all)
}

const UNKNOWN: &str = "no such key:";

fn check(root: &Value, schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let Some(parts) = parts(root, schema, value) else {
        return vec![format!("{at}: {value} is none of the alternatives")];
    };
    let mut faults = Vec::new();
    for part in &parts {
        if !is_of_type(&part["type"], value) {
            faults.push(format!("{at}: {value} is no {}", part["type"]));
        }
        let is_one = |choices: &Vec<Value>| choices.contains(value);
        if !part["enum"].as_array().is_none_or(is_one) || part.get("const").is_some_and(|only| only != value) {
            faults.push(format!("{at}: {value} is no choice"));
        }
        let required = part["required"]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str);
        let lacks = |key: &&str| value.get(key).is_none();
        faults.extend(required.filter(lacks).map(|key| format!("{at}: lacks {key}")));
    }
    if let Some(object) = value.as_object() {
        for (key, inner) in object {
            let known = parts.iter().find_map(|part| part["properties"].get(key));
            let of_map = parts.iter().find_map(|part| part.get("additionalProperties"));
            match known.or(of_map) {
                Some(schema) => faults.extend(check(root, schema, inner, &format!("{at}.{key}"))),
                None if parts.contains(&&Value::Bool(true)) => {}
                None => faults.push(format!("{UNKNOWN} {at}.{key}")),
            }
        }
    }
    for (i, inner) in value.as_array().into_iter().flatten().enumerate() {
        let of_all = |part: &&Value| part["prefixItems"].get(i).or(part.get("items")).cloned();
        if let Some(schema) = parts.iter().find_map(of_all) {
            faults.extend(check(root, &schema, inner, &format!("{at}[]")));
        }
    }
    faults
}

fn is_of_type(wanted: &Value, value: &Value) -> bool {
    let is = |name: &Value| match name.as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("string") => value.is_string(),
        Some("number") => value.is_number(),
        Some("integer") => value.is_i64() || value.is_u64(),
        Some("array") => value.is_array(),
        Some("object") => value.is_object(),
        _ => false,
    };
    match wanted {
        Value::Null => true,
        Value::Array(several) => several.iter().any(is),
        one => is(one),
    }
}

#[test]
fn what_differs_from_a_schema_is_found() {
    let schema = serde_json::json!({
        "type": "object",
        "properties": {"a": {"type": "number"}, "b": {"anyOf": [{"$ref": "#/$defs/B"}, {"type": "null"}]}},
        "required": ["a"],
        "$defs": {"B": {"type": "object", "properties": {"c": {"type": ["string", "null"]}}, "required": ["c"]}},
    });
    let found = |value: Value| check(&schema, &schema, &value, "");
    for good in [
        serde_json::json!({"a": 1}),
        serde_json::json!({"a": 0.5, "b": null}),
        serde_json::json!({"a": 0.5, "b": {"c": "d"}}),
    ] {
        assert_eq!(found(good), [""; 0]);
    }
    for bad in [
        serde_json::json!({}),
        serde_json::json!({"a": "1"}),
        serde_json::json!({"a": null}),
        serde_json::json!({"a": 1, "d": 2}),
        serde_json::json!({"a": 1, "b": {}}),
        serde_json::json!({"a": 1, "b": {"c": 1}}),
        serde_json::json!({"a": 1, "b": {"c": "d", "e": 1}}),
    ] {
        assert_eq!(found(bad.clone()).len(), 1, "{bad}");
    }
}
