//! What the YAML formats share: parsing with a one-line reason, numbers that every reader takes.

use serde::de::DeserializeOwned;

use super::CameraFault;

/// Parses YAML; the reason of a refusal is one line. OpenCV's `%YAML:1.0`, which is no YAML directive, and its tag
/// for matrices, which only OpenCV knows, are passed over.
pub(super) fn parse<T: DeserializeOwned>(text: &str, what: &'static str) -> Result<T, CameraFault> {
    let body = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    serde_saphyr::from_str(&body.replace("!!opencv-matrix", "")).map_err(|e| {
        // The first line of what the parser says, without its own "error: line …" frame.
        let reason = e.to_string();
        let line = reason.lines().next().unwrap_or_default();
        let behind_place = line.split_once("column ").map(|(_, rest)| rest);
        let reason = behind_place.map_or(line, |rest| rest.split_once(": ").map_or(rest, |(_, what)| what));
        CameraFault::Syntax {
            what,
            reason: reason.to_owned(),
        }
    })
}

/// Numbers between commas. Each reads back as the same value, and has a point and a signed exponent: without them YAML 1.1
/// readers (PyYAML, behind ROS and Kalibr) take 1e-7 for a word.
pub fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ")
}

fn number(value: f64) -> String {
    let text = format!("{value:?}");
    let Some((mantissa, exponent)) = text.split_once('e') else {
        return text;
    };
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{mantissa}{point}e{sign}{exponent}")
}
