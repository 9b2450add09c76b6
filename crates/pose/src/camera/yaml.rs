//! Shared parts of the YAML formats: parsing with a one-line reason, numbers that every reader accepts, and comments for values without a field in
//! any format: the bound of a guessed focal length, and standard deviations.

use serde::de::DeserializeOwned;
use serde_saphyr::NonFiniteFloatPolicy;

use super::{Camera, Guess};
use scaleproof_core::message::{Message, message};

const GUESS: &str = "# scaleproof: focal length guessed from EXIF, within percent: ";
const SIGMA: &str = "# scaleproof: standard deviations of fx, fy, cx, cy in px: ";

/// Type tags of OpenCV's matrices and Python's tuples, which other parsers do not know.
const TAGS: [&str; 3] = ["!!opencv-nd-matrix", "!!opencv-matrix", "!!python/tuple"];

/// Parses YAML; the reason of a refusal is one line. OpenCV's `%YAML:1.0`, which is not a YAML directive, and [`TAGS`] are skipped. Of several
/// documents, as ROS prints its messages, the first is read.
pub(super) fn parse<T: DeserializeOwned>(text: &str, what: &'static str) -> Result<T, Message> {
    let body = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    let body = TAGS
        .iter()
        .fold(first_document(body).to_owned(), |body, tag| body.replace(tag, ""));
    // A value that is not used may be `.nan`.
    let options = serde_saphyr::options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough };
    serde_saphyr::from_str_with_options(&body, options).map_err(|e| {
        // The first line of the parser's message, without its "error: line …" prefix.
        let reason = e.to_string();
        let line = reason.lines().next().unwrap_or_default();
        let behind_place = line.split_once("column ").map(|(_, rest)| rest);
        let reason = behind_place.map_or(line, |rest| rest.split_once(": ").map_or(rest, |(_, what)| what));
        message!("not {what}: {reason}")
    })
}

/// Returns the text before the line of dashes that ends the first document; such a line may also begin it.
fn first_document(text: &str) -> &str {
    let mut has_content = false;
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let is_end = line.trim_end() == "---";
        if is_end && has_content {
            return &text[..at];
        }
        has_content |= !is_end && !line.trim().is_empty() && !line.starts_with('#');
        at += line.len();
    }
    text
}

/// Formats numbers separated by commas. Each reads back as the same value, and has a point and a signed exponent: without them YAML 1.1 readers
/// (PyYAML, behind ROS and Kalibr) take 1e-7 for a word.
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

/// Returns the comment lines of a camera, each with its line end; empty if there are none.
pub(super) fn write_marks(camera: &Camera) -> String {
    let guess = camera.guess.map(|guess| (GUESS, list(&[guess.focal_percent])));
    let sigma = camera.sigma_px.map(|sigma| (SIGMA, list(&sigma)));
    let lines = guess.into_iter().chain(sigma);
    lines.map(|(mark, numbers)| format!("{mark}{numbers}\n")).collect()
}

/// Returns the camera with the values from its file's comments. Returns an error for a comment with an invalid number: without it a guess would pass
/// for a calibration.
pub(super) fn read_marks(text: &str, camera: Camera) -> Result<Camera, Message> {
    let guess = marked::<1>(text, GUESS)?.map(|[focal_percent]| Guess { focal_percent });
    Ok(Camera {
        guess,
        sigma_px: marked::<4>(text, SIGMA)?,
        ..camera
    })
}

fn marked<const N: usize>(text: &str, mark: &'static str) -> Result<Option<[f64; N]>, Message> {
    let Some(list) = text.lines().find_map(|line| line.trim().strip_prefix(mark.trim_end())) else {
        return Ok(None);
    };
    let numbers: Option<Vec<f64>> = list.split(',').map(|word| word.trim().parse().ok()).collect();
    numbers
        .filter(|numbers| numbers.iter().all(|v| v.is_finite() && *v >= 0.0))
        .and_then(|numbers| numbers.try_into().ok())
        .map(Some)
        .ok_or(message!(
            "the comment “{mark}…” must be followed by {count} number(s) not below 0",
            count = N
        ))
}
