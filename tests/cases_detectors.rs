//! Others' detectors through the program, a line for each case: what `detectors add` makes of files, what it refuses, and what the other commands then do.

use crate::common;
use crate::common::onnx::{self, Input, Output};

use std::path::Path;

use common::{assert_refused, home, program, stderr, stdout};

/// Runs `detectors` with words, in a folder; `@` in a word is the folder of the stored Darknet networks.
fn detectors(folder: &Path, line: &str) -> std::process::Output {
    let darknet = home().join("tests/data/cases/darknet").display().to_string();
    let words = line.split_whitespace().map(|word| word.replace('@', &darknet));
    program()
        .current_dir(folder)
        .arg("detectors")
        .args(words)
        .output()
        .unwrap()
}

/// A network that sees one box and one more, of the first two labels, in a photo of 96 × 64 pixels that lies beside it.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().unwrap();
    let at = |name: &str| desk.path().join(name);
    let mut rows = [10.0, 10.0, 50.0, 40.0, 0.9, 0.0].to_vec();
    rows.extend([60.0, 20.0, 90.0, 60.0, 0.8, 1.0]);
    rows.resize(300 * 6, 0.0);
    let output = Output::floats("output0", &[1, 300, 6], rows);
    let network = onnx::network(&[Input::floats("images", &[1, 3, 64, 96])], &[output]);
    std::fs::write(at("made.onnx"), network).unwrap();
    let strange = Output::floats("detections", &[1, 1333, 99], vec![0.5; 1333 * 99]);
    let network = onnx::network(&[Input::floats("images", &[1, 3, 64, 96])], &[strange]);
    std::fs::write(at("strange.onnx"), network).unwrap();
    std::fs::write(at("names.txt"), "PKW\nKombi\nein recht langer Name\n").unwrap();
    std::fs::write(at("four.txt"), "a\nb\nc\nd\n").unwrap();
    image::RgbImage::new(96, 64).save(at("photo.png")).unwrap();
    let labels = serde_json::json!({
        "images": [{"id": 1, "file_name": "photo.png"}],
        "annotations": [
            {"image_id": 1, "category_id": 3, "bbox": [10.0, 10.0, 40.0, 30.0]},
            {"image_id": 1, "category_id": 3, "bbox": [60.0, 20.0, 30.0, 40.0]},
        ],
        "categories": [{"id": 3, "name": "car"}],
    });
    std::fs::write(at("labels.json"), labels.to_string()).unwrap();
    desk
}

#[test]
fn each_line_does_what_it_should() {
    let desk = desk();
    // A command, and what its answer holds.
    let lines = [
        (
            "add @/tiny_v4.cfg @/tiny_v4.weights --labels four.txt -o tiny.toml",
            "manifest: tiny.toml",
        ),
        ("check --detector tiny.toml --confidence 0.1 photo.png", "on photo.png:"),
        (
            "add @/fastest.cfg @/fastest.weights --labels four.txt -o fastest.toml --json",
            "\"family\":\"darknet\"",
        ),
        (
            "add made.onnx --labels names.txt --map PKW=car,Kombi=car",
            "manifest: made.toml",
        ),
        // Two labels that count as one category.
        (
            "validate made.toml --coco labels.json --photos . --published 1.0",
            "AP@[.5:.95] 1.000, AP@0.5 1.000",
        ),
        (
            "check --detector made.toml photo.png",
            "PKW            0.900  [10, 10, 50, 40]  counts as car",
        ),
    ];
    for (line, expected) in lines {
        let output = detectors(desk.path(), line);
        assert!(output.status.success(), "{line}: {}", stderr(&output));
        assert!(stdout(&output).contains(expected), "{line}: {}", stdout(&output));
    }
}

#[test]
fn each_refusal_says_what_is_wrong() {
    let desk = desk();
    std::fs::write(desk.path().join("there.onnx"), "").unwrap();
    let lines: [(&str, &[&str]); 6] = [
        (
            "add @/v4.weights -o v4.toml",
            &["the .cfg of Darknet's .weights is needed"],
        ),
        ("add @/v4.cfg -o v4.toml", &["the .weights of a .cfg are needed"]),
        (
            "add made.onnx @/v4.weights --labels names.txt",
            &["a second file is needed only with Darknet's .cfg"],
        ),
        (
            "add @/v4.cfg @/fastest.weights -o v4.toml",
            &["fastest.weights", "fewer than", "another network's weights"],
        ),
        (
            "add @/v4.cfg @/v4.weights -o there.toml",
            &["there.onnx is already there"],
        ),
        (
            "add strange.onnx",
            &[
                "detections 1×1333×99",
                "no known family",
                "for an input of 96×64",
                "YOLOv8 to 12",
            ],
        ),
    ];
    for (line, words) in lines {
        assert_refused(&detectors(desk.path(), line), words);
    }
    // Labels are missing: the converted network goes too.
    assert_refused(
        &detectors(desk.path(), "add @/v4.cfg @/v4.weights -o v4.toml"),
        &["room for 4 labels"],
    );
    let left = |name: &str| desk.path().join(name).exists();
    assert!(!left("v4.onnx") && !left("v4.toml"));
}
