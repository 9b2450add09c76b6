//! `detectors validate`: the AP of labelled photos beside the published one, and the change of a manifest that explains a difference.

use crate::common;
use crate::common::onnx;

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
fn changed(folder: &Path, from: &str, to: &str) -> PathBuf {
    let weights = shared("detectors/yolox_nano.onnx");
    let text = std::fs::read_to_string(home().join("crates/detect/src/manifests/yolox_nano.toml")).unwrap();
    assert!(text.contains(from), "{text}");
    let text = text
        .replace("name = \"yolox_nano\"", "name = \"mine\"")
        .replace(from, to);
    std::fs::copy(weights, folder.join("yolox_nano.onnx")).unwrap();
    let path = folder.join("mine.toml");
    std::fs::write(&path, text).unwrap();
    path
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
#[ignore = "needs the shared material: ./run test --shared"]
fn what_a_manifest_says_otherwise_than_its_origin_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let labels = labelled(folder.path());
    let right = changed(folder.path(), "labels = ", "labels = ");
    let text = std::fs::read_to_string(&labels).unwrap();
    let more = text.replace("\"categories\":[", "\"categories\":[{\"id\":99,\"name\":\"zeppelin\"},");
    assert_ne!(more, text);
    std::fs::write(&labels, more).unwrap();
    let text = stdout(&validate(&right, &labels, &["--published", "0.5"]));
    assert!(text.contains(", over other labels: 1 left out"), "{text}");
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
    let labels = labelled(folder.path());
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
            scaleproof_detect::Manifest::named("yolox_nano")
                .map(|m| (0..79).map(move |i| m.labels.name(i).unwrap().to_owned()))
                .unwrap(),
        );
        let shifted = format!("{:?}", shifted.collect::<Vec<_>>());
        let path = changed(folder.path(), from, &to.replace("SHIFTED", &shifted));
        let output = validate(&path, &labels, &["--published", "0.9", "--json"]);
        let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
        println!("{explanation}: {}", report["trials"]);
        assert_eq!(report["trials"]["explained_by"], explanation, "{report}");
        let text = stdout(&validate(&path, &labels, &["--published", "0.9"]));
        assert!(text.contains(&format!("explained by: {explanation}")), "{text}");
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn bad_labels_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let labels = labelled(folder.path());
    let right = changed(folder.path(), "labels = ", "labels = ");
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

/// A network that answers by colour: each photo is a car if red, and a person if blue, over the whole of a wide photo at the top of its input.
fn colour_network() -> Vec<u8> {
    let whole = [0.0, 0.0, 64.0, 32.0];
    let parts = [
        onnx::step(
            "ReduceMean",
            &["images"],
            &["mean"],
            &[
                onnx::list_attribute("axes", &[2, 3]),
                onnx::whole_attribute("keepdims", 0),
            ],
        ),
        onnx::constant("colours", &[3, 2], &[20.0, -20.0, 0.0, 0.0, -20.0, 20.0]),
        onnx::step("MatMul", &["mean", "colours"], &["red_or_blue"], &[]),
        onnx::step("Sigmoid", &["red_or_blue"], &["scores"], &[]),
        onnx::whole_constant("shape", &[3], &[1, 2, 1]),
        onnx::step("Reshape", &["scores", "shape"], &["column"], &[]),
        onnx::constant("boxes", &[1, 2, 4], &[whole, whole].concat()),
        onnx::constant("labels", &[1, 2, 1], &[2.0, 0.0]),
        onnx::step(
            "Concat",
            &["boxes", "column", "labels"],
            &["output0"],
            &[onnx::whole_attribute("axis", 2)],
        ),
    ];
    onnx::graph(
        &onnx::Input::floats("images", &[1, 3, 64, 64]),
        &parts,
        &["output0"],
        13,
    )
}

/// Wide photos, red ones with a car and blue ones with a person, labelled in `labels.json`.
fn coloured_photos(folder: &Path) -> PathBuf {
    let (mut images, mut annotations) = (Vec::new(), Vec::new());
    for id in 0..24 {
        let (colour, category) = match id % 2 {
            0 => ([200, 90, 60], 3),
            _ => ([60, 90, 200], 1),
        };
        let file = format!("{id}.png");
        let photo = image::RgbImage::from_pixel(128, 64, image::Rgb(colour));
        photo.save(folder.join(&file)).unwrap();
        images.push(json!({"id": id, "file_name": file}));
        annotations.push(json!({"image_id": id, "category_id": category, "bbox": [0, 0, 128, 64]}));
    }
    let categories = json!([{"id": 1, "name": "person"}, {"id": 3, "name": "car"}]);
    let labels = folder.join("labels.json");
    let file = json!({"images": images, "annotations": annotations, "categories": categories});
    std::fs::write(&labels, file.to_string()).unwrap();
    labels
}

#[test]
fn the_order_of_channels_and_the_way_of_resizing_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let labels = coloured_photos(folder.path());
    let network = colour_network();
    std::fs::write(folder.path().join("made.onnx"), &network).unwrap();
    let manifest = |channels: &str, resize: &str| {
        format!(
            "name = \"made\"\ntitle = \"Made\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = \"coco80\"\npublished_ap = 1.0\n[weights]\n\
             file = \"made.onnx\"\nsha256 = \"{}\"\n[input]\nsize_px = [64, 64]\nresize = \"{resize}\"\nkernel = \"opencv_linear\"\npad = 114\n\
             channels = \"{channels}\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\nkind = \"yolov10\"\n",
            scaleproof_core::files::sha256_hex(&network)
        )
    };
    let path = folder.path().join("made.toml");
    let cases = [
        ("rgb", "letterbox_top_left", "published 1.000: the same within 0.01"),
        ("bgr", "letterbox_top_left", "explained by: channels rgb"),
        ("rgb", "stretch", "explained by: resize letterbox_top_left"),
        ("rgb", "letterbox_centre", "explained by: resize letterbox_top_left"),
    ];
    for (channels, resize, expected) in cases {
        std::fs::write(&path, manifest(channels, resize)).unwrap();
        let mut command = program();
        command
            .args(["detectors", "validate"])
            .arg(&path)
            .arg("--coco")
            .arg(&labels);
        let output = command.arg("--photos").arg(folder.path()).output().unwrap();
        let text = stdout(&output);
        assert!(
            text.contains(expected),
            "{channels} {resize}: {text}{}",
            stderr(&output)
        );
    }
}
