//! What the YAML formats share: parsing with a one-line reason, numbers that every reader takes;
//! and what no format has a place for, in comments that every format allows: that a camera is a guess, and standard deviations.

use serde::de::DeserializeOwned;
use serde_saphyr::NonFiniteFloatPolicy;

use super::{Camera, CameraFault, Guess};

const GUESS: &str = "# scaleproof: focal length guessed from EXIF, within percent: ";
const SIGMA: &str = "# scaleproof: standard deviations of fx, fy, cx, cy in px: ";

/// Tags of OpenCV's matrices and Python's tuples, which only these know.
const TAGS: [&str; 3] = ["!!opencv-nd-matrix", "!!opencv-matrix", "!!python/tuple"];

/// Parses YAML; the reason of a refusal is one line. OpenCV's `%YAML:1.0`, which is no YAML directive, and [`TAGS`] are passed over. Of several
/// documents, as ROS prints its messages, the first is read.
pub(super) fn parse<T: DeserializeOwned>(text: &str, what: &'static str) -> Result<T, CameraFault> {
    let body = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    let body = TAGS
        .iter()
        .fold(first_document(body).to_owned(), |body, tag| body.replace(tag, ""));
    // A figure that nobody reads may be `.nan`.
    let options = serde_saphyr::options! { non_finite_float_policy: NonFiniteFloatPolicy::PassThrough };
    serde_saphyr::from_str_with_options(&body, options).map_err(|e| {
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

/// What stands before the line of dashes that ends a document; one may also begin it.
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

/// The comment lines of a camera, each with its line end; none when there is nothing to say.
pub(super) fn write_marks(camera: &Camera) -> String {
    let guess = camera.guess.map(|guess| (GUESS, list(&[guess.focal_percent])));
    let sigma = camera.sigma_px.map(|sigma| (SIGMA, list(&sigma)));
    let lines = guess.into_iter().chain(sigma);
    lines.map(|(mark, numbers)| format!("{mark}{numbers}\n")).collect()
}

/// The camera with what the comments of its file say. A mark whose number was spoilt is refused: without it a guess would
/// pass for a calibration.
pub(super) fn read_marks(text: &str, camera: Camera) -> Result<Camera, CameraFault> {
    let guess = marked::<1>(text, GUESS)?.map(|[focal_percent]| Guess { focal_percent });
    Ok(Camera {
        guess,
        sigma_px: marked::<4>(text, SIGMA)?,
        ..camera
    })
}

fn marked<const N: usize>(text: &str, mark: &'static str) -> Result<Option<[f64; N]>, CameraFault> {
    let Some(list) = text.lines().find_map(|line| line.trim().strip_prefix(mark.trim_end())) else {
        return Ok(None);
    };
    let numbers: Option<Vec<f64>> = list.split(',').map(|word| word.trim().parse().ok()).collect();
    numbers
        .filter(|numbers| numbers.iter().all(|v| v.is_finite() && *v >= 0.0))
        .and_then(|numbers| numbers.try_into().ok())
        .map(Some)
        .ok_or(CameraFault::Comment { mark, count: N })
}
