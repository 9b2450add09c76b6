//! What a program answers about a photo, in one line.

use serde::Deserialize;

use super::super::foreign::placed;
use super::super::{Detection, Labels, MAX_DETECTIONS, SCORE_FLOOR};
use scaleproof_core::geometry::BoxPx;

/// More boxes than any detector has use for; the best hundred count.
const MOST_BOXES: usize = 10_000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    id: u64,
    detections: Option<Vec<Found>>,
    /// Why there are none, as a sentence.
    error: Option<String>,
    /// Size of the image that the program decoded, in px.
    width: Option<u32>,
    height: Option<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Found {
    label: Label,
    score: f64,
    /// Left, top, right, bottom in px of the upright photo.
    #[serde(rename = "box")]
    b: [f64; 4],
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "a label is a name or a number from 0")]
enum Label {
    Number(usize),
    Name(String),
}

/// The photo that was asked about.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub id: u64,
    /// Width, height of the upright photo, px.
    pub size: [u32; 2],
    pub labels: Labels,
}

/// What an answer comes to.
pub(super) enum Verdict {
    Detections(Vec<Detection>),
    /// The program gives no answer about this photo, and says why.
    Declined(String),
}

/// Reads an answer.
///
/// # Errors
/// Why nothing of the program can be trusted, as a sentence.
pub(super) fn parse(line: &str, asked: &Asked) -> Result<Verdict, String> {
    let answer: Answer = serde_json::from_str(line).map_err(|e| garbage(line, &e))?;
    if answer.id != asked.id {
        return Err(format!(
            "it is about photo {}, and asked was photo {}",
            answer.id, asked.id
        ));
    }
    if let Some(sentence) = answer.error {
        return Ok(Verdict::Declined(one_line(&sentence)));
    }
    let [width, height] = asked.size;
    if let Some((w, h)) = answer.width.zip(answer.height).filter(|size| *size != (width, height)) {
        let turned = if (h, w) == (width, height) {
            ": it did not turn it as its EXIF says"
        } else {
            ""
        };
        return Err(format!(
            "its boxes are of an image of {w}×{h} px, and the photo is {width}×{height} px upright{turned}"
        ));
    }
    let found = answer.detections.ok_or("it has neither detections nor an error")?;
    if found.len() > MOST_BOXES {
        return Err(format!(
            "it has {} boxes, more than the {MOST_BOXES} that are read",
            found.len()
        ));
    }
    let mut detections = Vec::with_capacity(found.len());
    for one in found {
        let label = label(&one.label, asked.labels)?;
        let b = BoxPx::from(one.b);
        if b.x2 < b.x1 || b.y2 < b.y1 {
            return Err(format!(
                "the corners of the box {:?} are not left, top, right, bottom",
                one.b
            ));
        }
        let kept = placed(label, one.score, b, asked.size)?;
        detections.extend(kept.filter(|d| d.score >= SCORE_FLOOR));
    }
    detections.sort_by(|a, b| b.score.total_cmp(&a.score));
    detections.truncate(MAX_DETECTIONS);
    // They are kept for the whole run, and so would be the room of all others.
    detections.shrink_to_fit();
    Ok(Verdict::Detections(detections))
}

fn label(given: &Label, labels: Labels) -> Result<usize, String> {
    match given {
        Label::Number(label) => labels.name(*label).map(|_| *label).ok_or_else(|| {
            format!(
                "the label {label} is none: they are numbered from 0 to {}",
                labels.count().saturating_sub(1)
            )
        }),
        Label::Name(name) => {
            let short: String = name.chars().take(60).collect();
            labels
                .find(name)
                .ok_or_else(|| format!("the label {short:?} is none of its {}", labels.count()))
        }
    }
}

/// The beginning of a program's sentence.
pub(super) fn one_line(sentence: &str) -> String {
    sentence
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .take(500)
        .collect()
}

/// What stands in place of JSON.
pub(super) fn garbage(line: &str, e: &serde_json::Error) -> String {
    let start: String = line.trim().chars().take(60).collect();
    let number = ["NaN", "Infinity"]
        .into_iter()
        .find(|word| e.is_syntax() && line.contains(word));
    match number {
        Some(word) => format!("it has {word} where a number belongs"),
        // The error may quote a whole key.
        None => format!(
            "it begins with {start:?}, which is no answer ({})",
            one_line(&e.to_string())
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: Asked = Asked {
        id: 7,
        size: [640, 480],
        labels: Labels::Coco80,
    };

    fn answered(line: &str) -> Result<Vec<Detection>, String> {
        parse(line, &ASKED).map(|verdict| match verdict {
            Verdict::Detections(found) => found,
            Verdict::Declined(why) => panic!("{why}"),
        })
    }

    #[test]
    fn boxes_come_best_first_and_are_cut_at_the_border() {
        let line = r#"{"id": 7, "detections": [{"label": "car", "score": 0.5, "box": [-30, 10, 50, 40]},
            {"label": 0, "score": 0.8, "box": [1, 2, 3, 4]}, {"label": "car", "score": 0.0001, "box": [1, 2, 3, 4]}]}"#;
        let found = answered(line).unwrap();
        let expected = [(0, 0.8, [1.0, 2.0, 3.0, 4.0]), (2, 0.5, [0.0, 10.0, 50.0, 40.0])];
        let expected = expected.map(|(label, score, b)| Detection::new(label, score, b.into()).unwrap());
        assert_eq!(found, expected);
        let declined = parse(r#"{"id": 7, "error": "out of\nmemory"}"#, &ASKED);
        assert!(matches!(declined, Ok(Verdict::Declined(why)) if why == "out of memory"));
    }

    #[test]
    fn lies_are_named() {
        let one = |found: &str| format!(r#"{{"id": 7, "detections": [{found}]}}"#);
        let many = vec![r#"{"label": 0, "score": 0.5, "box": [1, 2, 3, 4]}"#; MOST_BOXES + 1].join(",");
        for (line, words) in [
            ("ok".to_owned(), "it begins with \"ok\", which is no answer"),
            (String::new(), "which is no answer"),
            (
                r#"{"id": 8, "detections": []}"#.into(),
                "about photo 8, and asked was photo 7",
            ),
            (r#"{"id": 7}"#.into(), "neither detections nor an error"),
            (r#"{"id": 7, "boxes": []}"#.into(), "unknown field `boxes`"),
            (
                r#"{"id": 7, "detections": [], "width": 480, "height": 640}"#.into(),
                "did not turn it as its EXIF says",
            ),
            (
                one(r#"{"label": "carr", "score": 0.5, "box": [1, 2, 3, 4]}"#),
                "the label \"carr\" is none of its 80",
            ),
            (
                one(r#"{"label": 80, "score": 0.5, "box": [1, 2, 3, 4]}"#),
                "the label 80 is none: they are numbered from 0 to 79",
            ),
            (
                one(r#"{"label": 2, "score": NaN, "box": [1, 2, 3, 4]}"#),
                "NaN where a number belongs",
            ),
            (
                one(r#"{"label": 2, "score": 97.1, "box": [1, 2, 3, 4]}"#),
                "the confidence 97.1 is above 1",
            ),
            (
                one(r#"{"label": 2, "score": 0.5, "box": [30, 2, 3, 4]}"#),
                "not left, top, right, bottom",
            ),
            (
                one(r#"{"label": 2, "score": 0.5, "box": [700, 2, 730, 4]}"#),
                "lies outside the photo of 640×480 px",
            ),
            (
                one(r#"{"label": 2, "score": 0.5, "box": [1, 2, 3]}"#),
                "which is no answer",
            ),
            (one(&many), "10001 boxes"),
        ] {
            let error = answered(&line).unwrap_err();
            assert!(error.contains(words) && !error.contains('\n'), "{error}");
        }
        let long = format!(r#"{{"id": 7, "{}": 1}}"#, "x".repeat(1 << 20));
        assert!(answered(&long).unwrap_err().len() < 1000);
    }
}
