//! What a program answers about the loss of an image: a line, and behind it the loss's derivative by each value of the image.

use serde::{Deserialize, Deserializer};

use super::answer::{garbage, one_line};

/// The answer's line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    id: u64,
    /// `null` where no box meets the model.
    #[serde(default, deserialize_with = "given")]
    loss: Option<Option<f64>>,
    /// Of the array behind the line.
    shape: Option<Vec<u64>>,
    error: Option<String>,
}

/// Tells `null` from a key that is not there.
fn given<'a, D: Deserializer<'a>>(from: D) -> Result<Option<Option<f64>>, D::Error> {
    Option::deserialize(from).map(Some)
}

/// What the line of an answer comes to.
#[derive(Debug, PartialEq)]
pub(super) enum Head {
    /// The loss; the derivatives follow.
    Loss(f64),
    /// No box meets the model.
    Nothing,
    /// The program gives no answer about this image, and says why.
    Declined(String),
}

/// Reads the line of an answer about an image of a size in px.
///
/// # Errors
/// Why nothing of the program can be trusted, as a sentence.
pub(super) fn parse(line: &str, id: u64, size: [u32; 2]) -> Result<Head, String> {
    let answer: Answer = serde_json::from_str(line).map_err(|e| garbage(line, &e))?;
    if answer.id != id {
        return Err(format!("it is about image {}, and asked was image {id}", answer.id));
    }
    if let Some(sentence) = answer.error {
        return Ok(Head::Declined(one_line(&sentence)));
    }
    match (answer.loss, answer.shape) {
        (None, _) => Err("it has neither a loss nor an error".to_owned()),
        (Some(None), _) => Ok(Head::Nothing),
        (Some(Some(loss)), _) if !(0.0..=MOST_LOSS).contains(&loss) => Err(format!(
            "its loss is {loss}, and −ln(1 − C) of a confidence C is from 0 to {MOST_LOSS}"
        )),
        (Some(Some(_)), None) => Err("it has no shape of its gradient".to_owned()),
        (Some(Some(loss)), Some(shape)) => match shape_fault(&shape, size.map(u64::from)) {
            None => Ok(Head::Loss(loss)),
            Some(fault) => Err(fault),
        },
    }
}

/// 1 − C is not this near to 0 in any program's numbers.
const MOST_LOSS: f64 = 10_000.0;

fn shape_fault(shape: &[u64], [width, height]: [u64; 2]) -> Option<String> {
    let right = [height, width, 3];
    if shape == right {
        return None;
    }
    let hint = match shape {
        [1, rest @ ..] if rest.len() == 3 => ": it is that of a batch; leave out its first axis",
        [3, ..] => ": channels come last",
        shape if *shape == [width, height, 3] => ": rows come first",
        _ => "",
    };
    Some(format!(
        "its gradient has the shape {shape:?}, and the image has {right:?} (height, width, channels){hint}"
    ))
}

/// Numbers of 32 bits, the lowest byte first, as the derivatives by red, green and blue of each pixel.
///
/// # Errors
/// Where a number is none, as a sentence.
pub(super) fn derivatives(bytes: &[u8], width: u32) -> Result<Vec<[f64; 3]>, String> {
    let numbers: Vec<f64> = bytes
        .as_chunks()
        .0
        .iter()
        .map(|b| f64::from(f32::from_le_bytes(*b)))
        .collect();
    let pixels = numbers.as_chunks().0.to_vec();
    match numbers.iter().position(|v| !v.is_finite()) {
        None => Ok(pixels),
        Some(at) => {
            let (pixel, width) = (at / 3, width.max(1) as usize);
            Err(format!(
                "its gradient is {} at pixel x {}, y {}",
                numbers[at],
                pixel % width,
                pixel / width
            ))
        }
    }
}

/// An image's values as they go to a program.
pub(super) fn bytes(image: &[[f64; 3]]) -> Vec<u8> {
    image.iter().flatten().flat_map(|v| (*v as f32).to_le_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lies_about_losses_are_named() {
        let head = |line: &str| parse(line, 7, [640, 480]);
        assert_eq!(
            head(r#"{"id": 7, "loss": 0.25, "shape": [480, 640, 3]}"#),
            Ok(Head::Loss(0.25))
        );
        assert_eq!(head(r#"{"id": 7, "loss": null}"#), Ok(Head::Nothing));
        assert_eq!(
            head(r#"{"id": 7, "error": "out of\nmemory"}"#),
            Ok(Head::Declined("out of memory".into()))
        );
        for (line, words) in [
            (r#"{"id": 7}"#, "neither a loss nor an error"),
            (
                r#"{"id": 8, "loss": null}"#,
                "it is about image 8, and asked was image 7",
            ),
            (r#"{"id": 7, "loss": NaN}"#, "NaN where a number belongs"),
            (r#"{"id": 7, "loss": -0.5, "shape": [480, 640, 3]}"#, "its loss is -0.5"),
            (r#"{"id": 7, "loss": 0.5}"#, "no shape"),
            (
                r#"{"id": 7, "loss": 1, "shape": [3, 480, 640]}"#,
                "has the shape [3, 480, 640], and the image has [480, 640, 3] (height, width, channels): channels come last",
            ),
            (r#"{"id": 7, "loss": 1, "shape": [640, 480, 3]}"#, "rows come first"),
            (
                r#"{"id": 7, "loss": 1, "shape": [1, 480, 640, 3]}"#,
                "leave out its first axis",
            ),
            (
                r#"{"id": 7, "loss": 1, "shape": [416, 416]}"#,
                "has the shape [416, 416]",
            ),
        ] {
            let error = head(line).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn derivatives_are_those_of_the_pixels_and_what_is_no_number_is_found() {
        let mut image = vec![[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9], [1.0, 0.0, 0.25]];
        let read = derivatives(&bytes(&image), 2).unwrap();
        assert!(
            read.iter()
                .flatten()
                .zip(image.iter().flatten())
                .all(|(a, b)| (a - b).abs() < 1e-7)
        );
        image[2][1] = f64::NAN;
        assert_eq!(
            derivatives(&bytes(&image), 2),
            Err("its gradient is NaN at pixel x 0, y 1".into())
        );
    }
}
