//! Answers of programs: the boxes in a photo, in one line; or the loss of an image, in a line with the loss's derivative by each value of
//! the image behind it.

use serde::{Deserialize, Deserializer};

use super::super::foreign::{placed, turned_hint};
use super::super::{Detection, Labels, MAX_DETECTIONS, SCORE_FLOOR};
use scaleproof_core::coco::whole;
use scaleproof_core::geometry::BoxPx;

/// More boxes than any detector has use for; the best hundred count.
const MOST_BOXES: usize = 10_000;

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoAnswer {
    /// The program gives no answer about this image, and says why.
    Declined(String),
    /// Nothing of the program can be trusted.
    Fault(String),
}

impl<S: Into<String>> From<S> for NoAnswer {
    fn from(fault: S) -> NoAnswer {
        NoAnswer::Fault(fault.into())
    }
}

/// An answer's line about a photo.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxesLine {
    id: u64,
    detections: Option<Vec<FoundBox>>,
    /// Why there are none, as a sentence.
    error: Option<String>,
    /// Size of the image that the program decoded, in px.
    width: Option<u32>,
    height: Option<u32>,
}

/// A box as a program gives it, before it is checked.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FoundBox {
    pub label: FoundLabel,
    /// Confidence, 0 to 1.
    pub score: f64,
    /// Left, top, right, bottom in px of the upright photo.
    #[serde(rename = "box")]
    pub b: [f64; 4],
}

/// A label as a program gives it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a label is a name or a number from 0")]
pub enum FoundLabel {
    Number(#[serde(deserialize_with = "whole")] usize),
    Name(String),
}

impl FoundLabel {
    fn number(&self, labels: Labels) -> Result<usize, String> {
        let found = match self {
            FoundLabel::Number(label) => labels.name(*label).map(|_| *label),
            FoundLabel::Name(name) => labels.find(name),
        };
        found.ok_or_else(|| match self {
            FoundLabel::Number(label) => {
                let last = labels.count().saturating_sub(1);
                format!("the label {label} is none: they are numbered from 0 to {last}")
            }
            FoundLabel::Name(name) => format!("the label {:?} is none of its {}", start(name), labels.count()),
        })
    }
}

/// Reads the detections in the answer to the request `id` about a photo of width × height `size`, px, by a program with some labels; best
/// first.
pub fn detections(line: &str, id: u64, size: [u32; 2], labels: Labels) -> Result<Vec<Detection>, NoAnswer> {
    let answer: BoxesLine = serde_json::from_str(line).map_err(|e| garbage(line, &e))?;
    check("photo", [answer.id, id], answer.error)?;
    let [width, height] = size;
    if let Some((w, h)) = answer
        .width
        .zip(answer.height)
        .filter(|decoded| *decoded != (width, height))
    {
        let hint = turned_hint("it", [w, h], size);
        return Err(format!(
            "its boxes are of an image of {w}×{h} px, and the photo is {width}×{height} px upright{hint}"
        )
        .into());
    }
    let found = answer.detections.ok_or("it has neither detections nor an error")?;
    Ok(checked(found, size, labels)?)
}

/// Boxes in a photo of width × height `size`, px, as detections of some labels: best first, as many as count.
///
/// # Errors
/// A fault of one of them.
pub fn checked(found: Vec<FoundBox>, size: [u32; 2], labels: Labels) -> Result<Vec<Detection>, String> {
    if found.len() > MOST_BOXES {
        return Err(format!(
            "it has {} boxes, more than the {MOST_BOXES} that are read",
            found.len()
        ));
    }
    BoxPx::check_counts_pixels(found.iter().map(|one| one.b.into()))?;
    let mut detections = Vec::with_capacity(found.len());
    for one in found {
        let label = one.label.number(labels)?;
        let b = BoxPx::from(one.b);
        if b.x2 < b.x1 || b.y2 < b.y1 {
            return Err(format!(
                "the corners of the box {:?} are not left, top, right, bottom",
                one.b
            ));
        }
        let kept = placed(label, one.score, b, size)?;
        detections.extend(kept.filter(|d| d.score >= SCORE_FLOOR));
    }
    detections.sort_by(|a, b| b.score.total_cmp(&a.score));
    detections.truncate(MAX_DETECTIONS);
    // They are kept for the whole run, and so would be the room of all others.
    detections.shrink_to_fit();
    Ok(detections)
}

/// Refuses an answer to another request than the one that was asked, and one that says why there is none.
fn check(about: &str, [id, asked]: [u64; 2], error: Option<String>) -> Result<(), NoAnswer> {
    if id != asked {
        return Err(format!("it is about {about} {id}, and asked was {about} {asked}").into());
    }
    error.map_or(Ok(()), |sentence| Err(NoAnswer::Declined(one_line(&sentence))))
}

/// An answer's line about the loss of an image.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LossLine {
    id: u64,
    /// `null` where no box meets the model.
    #[serde(default, deserialize_with = "given")]
    loss: Option<Option<f64>>,
    /// Sides of the array behind the line.
    shape: Option<Vec<u64>>,
    error: Option<String>,
}

/// Tells `null` from a key that is not there.
fn given<'a, D: Deserializer<'a>>(from: D) -> Result<Option<Option<f64>>, D::Error> {
    Option::deserialize(from).map(Some)
}

/// 1 − C is not this near to 0 in any program's numbers.
const MOST_LOSS: f64 = 10_000.0;

/// Reads the loss in the answer to the request `id` about an image of width × height `size`, px; `None` where no box meets the model. Behind
/// the line of a loss follow its derivatives.
pub fn loss(line: &str, id: u64, size: [u32; 2]) -> Result<Option<f64>, NoAnswer> {
    let answer: LossLine = serde_json::from_str(line).map_err(|e| garbage(line, &e))?;
    check("image", [answer.id, id], answer.error)?;
    let Some(loss) = answer.loss.ok_or("it has neither a loss nor an error")? else {
        return Ok(None);
    };
    if !(0.0..=MOST_LOSS).contains(&loss) {
        return Err(format!("its loss is {loss}, and −ln(1 − C) of a confidence C is from 0 to {MOST_LOSS}").into());
    }
    check_shape("gradient", answer.shape, size)?;
    Ok(Some(loss))
}

/// Refuses what is not as large as an image of width × height `size`, px.
fn check_shape(what: &str, shape: Option<Vec<u64>>, size: [u32; 2]) -> Result<(), String> {
    let shape = shape.ok_or_else(|| format!("it has no shape of its {what}"))?;
    let [width, height] = size.map(u64::from);
    let right = [height, width, 3];
    let hint = match &shape[..] {
        shape if *shape == right => return Ok(()),
        [1, _, _, _] => ": it is that of a batch; leave out its first axis",
        [3, ..] => ": channels come last",
        shape if *shape == [width, height, 3] => ": rows come first",
        _ => "",
    };
    Err(format!(
        "its {what} has the shape {shape:?}, and the image has {right:?} (height, width, channels){hint}"
    ))
}

/// An answer's line about an image that a program changed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ImageLine {
    id: u64,
    /// Sides of the array of bytes behind the line.
    shape: Option<Vec<u64>>,
    error: Option<String>,
}

/// Reads the answer to the request `id` to change an image of width × height `size`, px. Behind its line follow red, green and blue of each pixel.
pub fn image(line: &str, id: u64, size: [u32; 2]) -> Result<(), NoAnswer> {
    let answer: ImageLine = serde_json::from_str(line).map_err(|e| garbage(line, &e))?;
    check("image", [answer.id, id], answer.error)?;
    Ok(check_shape("image", answer.shape, size)?)
}

/// Reads the derivatives by red, green and blue of each pixel of an image: numbers of 32 bits, the lowest byte first.
pub fn derivatives(bytes: &[u8], width: u32) -> Result<Vec<[f64; 3]>, NoAnswer> {
    let numbers = bytes.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b)));
    let numbers: Vec<f64> = numbers.collect();
    match numbers.iter().position(|v| !v.is_finite()) {
        None => Ok(numbers.as_chunks().0.to_vec()),
        Some(at) => {
            let (pixel, width) = (at / 3, width.max(1) as usize);
            let (x, y) = (pixel % width, pixel / width);
            Err(format!("its gradient is {} at pixel x {x}, y {y}", numbers[at]).into())
        }
    }
}

/// The beginning of a program's sentence.
pub(super) fn one_line(sentence: &str) -> String {
    let shown = sentence.chars().map(|c| if c.is_control() { ' ' } else { c });
    shown.take(500).collect()
}

/// The beginning of what a program says, to be quoted.
pub(super) fn start(text: &str) -> String {
    text.chars().take(60).collect()
}

/// Says what stands in place of JSON.
fn garbage(line: &str, e: &serde_json::Error) -> String {
    let number = ["NaN", "Infinity"]
        .into_iter()
        .find(|word| e.is_syntax() && line.contains(word));
    match number {
        Some(word) => format!("it has {word} where a number belongs"),
        // The error may quote a whole key.
        None => format!(
            "it begins with {:?}, which is no answer ({})",
            start(line.trim()),
            one_line(&e.to_string())
        ),
    }
}
