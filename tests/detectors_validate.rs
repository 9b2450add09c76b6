//! `detectors validate`: the AP of labelled photos beside the published one, and the change of a manifest that explains a difference.

use crate::tests::common;

use std::path::{Path, PathBuf};

use common::{assert_refused, home, program, shared, stderr, stdout};
use serde_json::{Value, json};

/// The stored photos of the plain car and where it is in them, as another program would have labelled them.
fn labelled(folder: &Path) -> PathBuf {
    let session = common::read_json(&home().join("captures/skyline/session.json"));
    let truth = common::read_json(&home().join("captures/skyline/truth.json"));
    let photos = session["photos"].as_array().unwrap().iter();
    let plain = photos.filter(|photo| photo["variant"] == "normal");
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    for (id, photo) in plain.enumerate() {
        let file = photo["file"].as_str().unwrap();
        images.push(json!({"id": id, "file_name": file}));
        let b = truth_box(&truth, file);
        let bbox = [b[0], b[1], b[2] - b[0], b[3] - b[1]];
        annotations.push(json!({"image_id": id, "category_id": 3, "bbox": bbox}));
    }
    let file = json!({
        "images": images,
        "annotations": annotations,
        "categories": [{"id": 3, "name": "car"}],
    });
    let path = folder.join("labels.json");
    std::fs::write(&path, file.to_string()).unwrap();
    path
}

fn truth_box(truth: &Value, file: &str) -> [f64; 4] {
    let photos = truth["photos"].as_array().unwrap();
    let photo = photos.iter().find(|photo| photo["file"] == file).unwrap();
    serde_json::from_value(photo["box_xyxy_px"].clone()).unwrap()
}

/// The manifest of yolox_nano under another name, with a text replaced.
fn changed(folder: &Path, from: &str, to: &str) -> Option<PathBuf> {
    let weights = shared("detectors/yolox_nano.onnx")?;
    let text = std::fs::read_to_string(home().join("src/detect/manifests/yolox_nano.toml")).unwrap();
    assert!(text.contains(from), "{text}");
    let text = text
        .replace("name = \"yolox_nano\"", "name = \"mine\"")
        .replace(from, to);
    std::fs::copy(weights, folder.join("yolox_nano.onnx")).unwrap();
    let path = folder.join("mine.toml");
    std::fs::write(&path, text).unwrap();
    Some(path)
}

fn validate(detector: &Path, labels: &Path, more: &[&str]) -> std::process::Output {
    let mut command = program();
    command
        .args(["detectors", "validate"])
        .arg(detector)
        .arg("--coco")
        .arg(labels);
    command.arg("--photos").arg(home().join("captures/skyline"));
    command.args(more).output().unwrap()
}

#[test]
fn what_a_manifest_says_otherwise_than_its_origin_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let labels = labelled(folder.path());
    let Some(right) = changed(folder.path(), "labels = ", "labels = ") else {
        return;
    };
    let text = std::fs::read_to_string(&labels).unwrap();
    let more = text.replace("\"categories\":[", "\"categories\":[{\"id\":99,\"name\":\"zeppelin\"},");
    assert_ne!(more, text);
    std::fs::write(&labels, more).unwrap();
    let output = validate(&right, &labels, &["--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("no label for these categories, which are left out: zeppelin"));
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(
        (&report["photos"], &report["boxes"], &report["labels"]),
        (&json!(8), &json!(8), &json!(1))
    );
    let ap = report["averages"]["ap_50_95"].as_f64().unwrap();
    assert!(ap > 0.5, "{report}");
    // On these 8 photos a stretched input finds more, by a chance that resampled photos show.
    assert_eq!(report["trials"]["explained_by"], Value::Null, "{report}");
    let text = stdout(&validate(&right, &labels, &[]));
    assert!(
        text.contains("none of these changes gains 0.02 beyond chance"),
        "{text}"
    );
    // As published, nothing is tried.
    let output = validate(&right, &labels, &["--published", &format!("{:.3}", ap - 0.005)]);
    let text = stdout(&output);
    assert!(
        text.contains("the same within 0.01") && !text.contains("explained"),
        "{text}"
    );
    let wrong = [
        (
            "std = [1.0, 1.0, 1.0]",
            "std = [255.0, 255.0, 255.0]",
            "values 0 to 255",
        ),
        (
            "labels = \"coco80\"",
            "labels = SHIFTED",
            "labels one entry further down",
        ),
    ];
    for (from, to, explanation) in wrong {
        let shifted = std::iter::once("background".to_owned()).chain(
            scaleproof::detect::Manifest::named("yolox_nano")
                .map(|m| (0..79).map(move |i| m.labels.name(i).unwrap().to_owned()))
                .unwrap(),
        );
        let shifted = format!("{:?}", shifted.collect::<Vec<_>>());
        let path = changed(folder.path(), from, &to.replace("SHIFTED", &shifted)).unwrap();
        let output = validate(&path, &labels, &["--published", "0.9", "--json"]);
        let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
        println!("{explanation}: {}", report["trials"]);
        assert_eq!(report["trials"]["explained_by"], explanation, "{report}");
        let text = stdout(&validate(&path, &labels, &["--published", "0.9"]));
        assert!(text.contains(&format!("explained by: {explanation}")), "{text}");
    }
}

#[test]
fn bad_labels_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let labels = labelled(folder.path());
    let Some(right) = changed(folder.path(), "labels = ", "labels = ") else {
        return;
    };
    let text = std::fs::read_to_string(&labels).unwrap();
    let broken = [
        (
            text.replace("\"name\":\"car\"", "\"name\":\"boat house\""),
            "none of its categories (\"boat house\") is a label",
        ),
        (
            text.replacen("\"image_id\":0", "\"image_id\":77", 1),
            "an annotation names image 77",
        ),
        (
            text.replacen("normal_000.jpg", "../normal_000.jpg", 1),
            "leaves the folder of photos",
        ),
        (
            text.replacen(
                "\"file_name\":\"normal_000.jpg\",\"id\":0",
                "\"file_name\":\"normal_000.jpg\",\"id\":1",
                1,
            ),
            "its id appears twice",
        ),
        (text[..text.len() / 2].to_owned(), "line 1"),
        (text.replacen("normal_000.jpg", "no_such.jpg", 1), "no_such.jpg"),
    ];
    for (text, words) in broken {
        std::fs::write(&labels, text).unwrap();
        assert_refused(&validate(&right, &labels, &[]), &[words]);
    }
    assert_refused(
        &validate(&right, &labels, &["--published", "25.8"]),
        &["--published is 25.8: give an AP from 0 to 1"],
    );
}
