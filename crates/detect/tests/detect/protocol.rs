//! What programs say: their hellos, their answers, and the lies in them.

use scaleproof_detect::protocol::{Hello, InputRule, NoAnswer, derivatives, detections, loss};
use scaleproof_detect::{Detection, Labels};

/// More boxes than are read.
const MOST_BOXES: usize = 10_000;

fn parse(line: &str) -> Result<Vec<Detection>, NoAnswer> {
    detections(line, 7, [640, 480], Labels::Coco80)
}

fn answered(line: &str) -> Result<Vec<Detection>, String> {
    parse(line).map_err(|why| match why {
        NoAnswer::Fault(fault) => fault,
        NoAnswer::Declined(why) => panic!("{why}"),
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
    let declined = parse(r#"{"id": 7, "error": "out of\nmemory"}"#);
    assert!(matches!(declined, Err(NoAnswer::Declined(why)) if why == "out of memory"));
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
        (
            one(
                r#"{"label": 2.0, "score": 0.5, "box": [0.2, 0.3, 0.7, 0.9]}, {"label": 2, "score": 0, "box": [0, 0, 0, 0]}"#,
            ),
            "look like shares of the photo's width and height",
        ),
    ] {
        let error = answered(&line).unwrap_err();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    }
    let long = format!(r#"{{"id": 7, "{}": 1}}"#, "x".repeat(1 << 20));
    assert!(answered(&long).unwrap_err().len() < 1000);
}

/// An image's values as they go to a program, and derivatives as they come.
fn bytes(image: &[[f64; 3]]) -> Vec<u8> {
    image.iter().flatten().flat_map(|v| (*v as f32).to_le_bytes()).collect()
}

#[test]
fn lies_about_losses_are_named() {
    let head = |line: &str| loss(line, 7, [640, 480]);
    assert_eq!(
        head(r#"{"id": 7, "loss": 0.25, "shape": [480, 640, 3]}"#),
        Ok(Some(0.25))
    );
    assert_eq!(head(r#"{"id": 7, "loss": null}"#), Ok(None));
    assert_eq!(
        head(r#"{"id": 7, "error": "out of\nmemory"}"#),
        Err(NoAnswer::Declined("out of memory".into()))
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
        assert!(
            matches!(&error, NoAnswer::Fault(fault) if fault.contains(words)),
            "{error:?}"
        );
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
        Err(NoAnswer::Fault("its gradient is NaN at pixel x 0, y 1".into()))
    );
}

fn hello(change: &str) -> Result<Hello, String> {
    let usual = r#"{"scaleproof_detector": 1, "name": "mine", "version": "1.0", "labels": "coco80", "input": "rgb"}"#;
    Hello::parse(&usual.replace("\"name\": \"mine\"", change))
}

#[test]
fn a_hello_says_what_is_needed_and_nothing_else() {
    let usual = hello(r#""name": "mine""#).unwrap();
    assert_eq!(
        (usual.workers, usual.deterministic, usual.input),
        (1, false, InputRule::Rgb)
    );
    for (change, words) in [
        (r#""name": "my car""#, "name is \"my car\""),
        (r#""nam": "mine""#, "unknown field `nam`"),
        (r#""name": "mine", "workers": 0"#, "workers is 0"),
        (r#""name": "mine", "title": "a\nb""#, "control characters"),
        (
            r#""name": "mine", "gradients": "some""#,
            "gradients is true, false or \"partial\"",
        ),
    ] {
        let error = hello(change).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
    assert!(
        Hello::parse("Loading weights…")
            .unwrap_err()
            .contains("\"Loading weights…\" and not its hello")
    );
    let long = "x".repeat(1 << 20);
    for change in [
        format!(r#""name": "{long}""#),
        format!(r#""name": "mine", "{long}": 1"#),
        format!(r#""name": "mine", "gradients": "{long}""#),
    ] {
        assert!(hello(&change).unwrap_err().len() < 1000);
    }
    let other = r#"{"scaleproof_detector": 2, "name": "mine", "version": "", "labels": ["a"], "input": "path"}"#;
    assert!(Hello::parse(other).unwrap_err().contains("version 2"));
}
