//! The detectors: a tiny network made here, run by ONNX Runtime, and the five real ones against published scores.

use crate::common;

use std::path::Path;

use common::{assert_refused, program, shared, skyline, stdout};
use scaleproof_detect::{Detector, Manifest, Recorded, RecordedPhoto, Recording, Runtime, Speeds};

use crate::common::onnx;

/// A YOLOX answer with one box: centre (208, 104), 104 × 52 input pixels, at stride 8, car .72, truck .18.
fn yolox_answer() -> Vec<f32> {
    let mut data = vec![0.0_f32; 3549 * 85];
    let row = &mut data[(13 * 52 + 26) * 85..][..85];
    row[..5].copy_from_slice(&[0.0, 0.0, 13.0_f32.ln(), 6.5_f32.ln(), 0.9]);
    (row[5 + 2], row[5 + 7]) = (0.8, 0.2);
    data
}

fn constant_network(shape: &[usize], data: Vec<f32>) -> Vec<u8> {
    onnx::network(
        &[onnx::Input::floats("images", &[1, 3, 416, 416])],
        &[onnx::Output::floats("output", shape, data)],
    )
}

#[test]
fn a_network_made_here_runs_and_its_box_lands_in_the_photo() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiny.onnx");
    std::fs::write(&path, constant_network(&[1, 3549, 85], yolox_answer())).unwrap();
    let manifest = Manifest::named("yolox_nano").unwrap();
    let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &path).unwrap();
    // An odd size: the ratio is 416 / 1001.
    let found = detector.detect(&image::RgbImage::new(1001, 613)).unwrap();
    let car = &found[0];
    assert_eq!((car.label, (car.score - 0.72).abs() < 1e-6), (2, true));
    let ratio = 1001.0 / 416.0;
    let wanted = [156.0, 78.0, 260.0, 130.0].map(|v| v * ratio);
    let b: [f64; 4] = car.box_px.into();
    for (found, wanted) in b.iter().zip(wanted) {
        assert!((found - wanted).abs() < 0.02, "{b:?}");
    }
}

/// A sigmoid may round up to a hair above 1, which no file of results may have.
#[test]
fn a_score_a_hair_above_one_survives_its_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiny.onnx");
    let mut answer = yolox_answer();
    let row = &mut answer[(13 * 52 + 26) * 85..][..85];
    (row[4], row[5 + 2]) = (1.0, 1.0005);
    std::fs::write(&path, constant_network(&[1, 3549, 85], answer)).unwrap();
    let manifest = Manifest::named("yolox_nano").unwrap();
    let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &path).unwrap();
    let found = detector.detect(&image::RgbImage::new(1001, 613)).unwrap();
    assert_eq!((found[0].label, found[0].score), (2, 1.0));
    let photo = RecordedPhoto {
        id: 1,
        file: "a.jpg".into(),
        sha256: "0a".into(),
    };
    let recording = Recording {
        detector: manifest.name.clone(),
        weights_sha256: manifest.weights.sha256.clone(),
        results_sha256: String::new(),
        scaleproof: String::new(),
        runtime: String::new(),
        score_floor: 0.001,
        photos: vec![photo],
    };
    Recorded::save(folder.path(), &manifest, recording, &[found.as_slice()]).unwrap();
    let recorded = Recorded::open(folder.path(), &manifest).unwrap();
    assert_eq!(recorded.of_photo("0a"), Some(&found[..]));
}

#[test]
fn a_network_that_does_not_fit_its_manifest_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.onnx");
    std::fs::write(&path, constant_network(&[1, 10, 85], vec![0.0; 850])).unwrap();
    let manifest = Manifest::named("yolox_nano").unwrap();
    let mut detector = Detector::open(Runtime::load().unwrap(), &manifest, &path).unwrap();
    let error = detector.detect(&image::RgbImage::new(64, 48)).unwrap_err().to_string();
    assert!(
        error.contains("yolox_nano failed") && error.contains("does not fit this file"),
        "{error}"
    );
    std::fs::write(&path, b"not a network").unwrap();
    let error = Detector::open(Runtime::load().unwrap(), &manifest, &path)
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("other.onnx is not a model"), "{error}");
}

/// Writes a network into a folder, `mine.onnx`, and returns the text of its manifest.
fn own_manifest(folder: &Path) -> String {
    let network = constant_network(&[1, 3549, 85], yolox_answer());
    std::fs::write(folder.join("mine.onnx"), &network).unwrap();
    let built_in = std::fs::read_to_string(common::home().join("crates/detect/src/manifests/yolox_nano.toml")).unwrap();
    let hash = scaleproof_core::files::sha256_hex(&network);
    built_in
        .replace("\"yolox_nano\"", "\"mine\"")
        .replace("yolox_nano.onnx", "mine.onnx")
        .replace(
            "695e750a5d5754bb5a8d5325643b59282191a7e7a564e435a415fd3c578eab14",
            &hash,
        )
}

#[test]
fn times_are_measured_and_kept_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let (manifest, file) = (folder.path().join("mine.toml"), folder.path().join("speed.json"));
    std::fs::write(&manifest, own_manifest(folder.path())).unwrap();
    let speed = |more: &[&std::ffi::OsStr]| {
        let mut command = program();
        command
            .args(["detectors", "speed", "--machine", "a test", "-o"])
            .arg(&file);
        command
            .arg(skyline().join("normal_000.jpg"))
            .args(more)
            .output()
            .unwrap()
    };
    // Without any weights there is nothing to time, and no file.
    assert_refused(&speed(&[]), &["no detector's weights are here"]);
    assert!(!file.exists());
    let output = speed(&["--detector".as_ref(), manifest.as_os_str()]);
    assert!(output.status.success(), "{}", common::stderr(&output));
    let manifest = Manifest::open(&manifest).unwrap();
    let speeds = Speeds::open(&file, &[&manifest]).unwrap();
    let time = speeds.find("mine").unwrap();
    assert_eq!(
        (speeds.photos, speeds.megapixels, speeds.machine.as_str()),
        (1, 1.23, "a test")
    );
    assert_eq!(time.weights_sha256, manifest.weights.sha256);
    assert!(
        time.ms_range == [time.ms_per_photo; 2] && time.ms_per_photo < 10_000.0,
        "{time:?}"
    );
}

/// A manifest beside its network is named by its path; nothing but the name differs from a built-in one.
#[test]
fn a_manifest_of_the_users_own_runs_by_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let mine = own_manifest(folder.path());
    let check = |text: &str| {
        let manifest = folder.path().join("mine.toml");
        std::fs::write(&manifest, text).unwrap();
        let mut command = program();
        command
            .args(["detectors", "check", "--json", "--detector"])
            .arg(manifest);
        command.arg(skyline().join("normal_000.jpg")).output().unwrap()
    };
    let line: serde_json::Value = serde_json::from_str(stdout(&check(&mine)).lines().next().unwrap()).unwrap();
    assert_eq!((&line["detector"], &line["label"]), (&"mine".into(), &"car".into()));
    assert_refused(
        &check(&mine.replace("\"mine\"", "\"yolox_nano\"")),
        &["mine.toml", "ships with scaleproof"],
    );
    assert_refused(
        &check(&mine.replace("\"mine\"", "\"../mine\"")),
        &["mine.toml", "files are named by it"],
    );
    assert_refused(
        &check(&mine.replace("[416, 416]", "[0, 416]")),
        &["input.size_px is [0, 416]"],
    );
}

/// One box, always the same, as YOLOv10 answers: x1 y1 x2 y2, score, label.
fn one_box(label: f32) -> onnx::Output {
    onnx::Output::floats("output0", &[1, 1, 6], vec![8.0, 8.0, 56.0, 56.0, 0.9, label])
}

fn small_picture() -> onnx::Input {
    onnx::Input::floats("images", &[1, 3, 64, 64])
}

/// `score` with a detector made here, on a session of three images with their truth given: grey, black, grey.
fn score_with(network: &[u8], labels: &str, head: &str) -> (std::process::Output, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::write(folder.path().join("made.onnx"), network).unwrap();
    let hash = scaleproof_core::files::sha256_hex(network);
    write(
        "made.toml",
        &format!(
            "name = \"made\"\ntitle = \"Made\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = {labels}\n[weights]\n\
             file = \"made.onnx\"\nsha256 = \"{hash}\"\n[input]\nsize_px = [64, 64]\nresize = \"stretch\"\nkernel = \"opencv_linear\"\n\
             channels = \"rgb\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\n{head}\n"
        ),
    );
    write(
        "scene.toml",
        "[model]\nname='m'\nscale=10\nclass='car'\nsize_mm=[400,180,120]\n[bins]\nazimuth_deg=45\npitch_deg=[15]\ndistance_mm=[800]\n",
    );
    write(
        "camera.yaml",
        "image_width: 64\nimage_height: 64\ncamera_matrix: {rows: 3, cols: 3, data: [60, 0, 31.5, 0, 60, 31.5, 0, 0, 1]}\n\
         distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n",
    );
    let mut photos = Vec::new();
    for (i, grey) in [120, 0, 200].into_iter().enumerate() {
        let file = format!("{i}.png");
        let picture = image::RgbImage::from_pixel(64, 64, image::Rgb([grey; 3]));
        picture.save(folder.path().join(&file)).unwrap();
        photos.push(
            serde_json::json!({"file": file, "variant": "normal", "box_xyxy_px": [8, 8, 56, 56],
            "viewpoint": {"azimuth_deg": 90.0 * i as f64, "pitch_deg": 15, "distance_mm": 800}}),
        );
    }
    let session = serde_json::json!({"scene": "scene.toml", "camera": "camera.yaml", "photos": photos});
    write("session.json", &session.to_string());
    let mut command = program();
    command
        .arg("score")
        .arg(folder.path())
        .arg("--out")
        .arg(folder.path().join("out"));
    command.arg("--detector").arg(folder.path().join("made.toml"));
    (command.output().unwrap(), folder)
}

#[test]
fn a_photo_that_is_answered_with_nan_is_left_out_and_the_others_are_scored() {
    let network = onnx::network_blind_in_the_dark(&small_picture(), &[one_box(2.0)], 0.1);
    let (output, folder) = score_with(&network, "\"coco80\"", "kind = \"yolov10\"");
    let text = common::stderr(&output);
    assert!(output.status.success(), "{text}");
    assert!(
        text.contains("1.png: made answered with NaN in its output output0"),
        "{text}"
    );
    let summary = common::read_json(&folder.path().join("out/summary.json"));
    assert_eq!(summary["photos_scored"], 2);
    assert_eq!(summary["results"][0]["overall"]["hit_rate"]["count"], 2);
    assert_eq!(summary["not_scored"][0]["file"], "1.png");
    // On every photo: nothing can be scored.
    let network = onnx::network_blind_in_the_dark(&small_picture(), &[one_box(2.0)], 2.0);
    let (output, folder) = score_with(&network, "\"coco80\"", "kind = \"yolov10\"");
    assert_refused(&output, &["none of the 3 photos could be scored", "NaN"]);
    assert!(!folder.path().join("out").exists());
}

#[test]
fn detectors_that_their_manifest_does_not_describe_are_refused_before_anything_is_written() {
    let network = onnx::network(&[small_picture()], &[one_box(80.0)]);
    let refused = |network: &[u8], labels: &str, head: &str, words: &[&str]| {
        let (output, folder) = score_with(network, labels, head);
        assert_refused(&output, words);
        assert!(!folder.path().join("out").exists(), "something was left behind");
    };
    let end_to_end = "kind = \"yolov10\"";
    refused(
        &network,
        "\"coco80\"",
        end_to_end,
        &["made failed", "label 80", "not among the 80"],
    );
    refused(
        &network,
        "[\"truck\", \"bus\"]",
        end_to_end,
        &["made has no label `car`"],
    );
    refused(
        &network,
        "[\"car\", \"car\"]",
        end_to_end,
        &["made.toml", "\"car\" is listed twice"],
    );
    for (nms_iou, said) in [("nan", "NaN"), ("-1.0", "-1"), ("7.0", "7")] {
        let head = format!("kind = \"yolov8\"\nnms_iou = {nms_iou}");
        refused(
            &network,
            "\"coco80\"",
            &head,
            &["made.toml", "head.nms_iou is", said, "from 0 to 1"],
        );
    }
    let logits = onnx::Output::floats("output0", &[1, 1, 6], vec![8.0, 8.0, 56.0, 56.0, 5.0, 2.0]);
    let unbounded = onnx::network(&[small_picture()], &[logits]);
    refused(
        &unbounded,
        "\"coco80\"",
        end_to_end,
        &["made gives a box the score 5", "sigmoid"],
    );
    let endless = onnx::Output::floats("output0", &[1, 1, 6], vec![8.0, 8.0, f32::INFINITY, 56.0, 0.9, 2.0]);
    let endless = onnx::network(&[small_picture()], &[endless]);
    refused(
        &endless,
        "\"coco80\"",
        end_to_end,
        &["made answered with infinity in its output output0"],
    );
    let minus = onnx::Output::floats("output0", &[1, 1, 6], vec![8.0, 8.0, f32::NEG_INFINITY, 56.0, 0.9, 2.0]);
    refused(
        &onnx::network(&[small_picture()], &[minus]),
        "\"coco80\"",
        end_to_end,
        &["made answered with a box that is not finite", "in its output output0"],
    );
    let head = "kind = \"yolov8\"\nnms_iou = 0.7";
    refused(
        &network,
        "\"coco80\"",
        head,
        &["made failed", "output0 [1, 1, 6]", "does not fit this file"],
    );
    let other_size = onnx::network(&[onnx::Input::floats("images", &[1, 3, 32, 32])], &[one_box(2.0)]);
    refused(&other_size, "\"coco80\"", end_to_end, &["made failed", "images"]);
}

#[test]
fn the_list_says_what_there_is_and_what_is_missing() {
    let output = program().args(["detectors", "list"]).output().unwrap();
    let text = stdout(&output);
    for m in Manifest::all().unwrap() {
        assert!(text.contains(&m.name) && text.contains(&m.licence), "{text}");
    }
    assert_eq!(text.matches("not here").count(), 5, "{text}");
    let output = program().args(["detectors", "list", "--json"]).output().unwrap();
    let lines: Vec<serde_json::Value> = stdout(&output)
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines[0]["name"], "yolox_nano");
    assert!(lines[0]["path"].is_null() && lines[0]["url"].as_str().unwrap().ends_with("yolox_nano.onnx"));
}

#[test]
fn without_weights_or_network_the_refusals_say_what_to_do() {
    let photo = skyline().join("normal_000.jpg");
    let output = program().args(["detectors", "check"]).arg(&photo).output().unwrap();
    assert_refused(
        &output,
        &["no detector's weights are here", "scaleproof detectors fetch"],
    );
    let output = program()
        .args(["detectors", "check", "--detector", "yolo99"])
        .arg(&photo)
        .output()
        .unwrap();
    assert_refused(&output, &["no detector is called yolo99", "yolox_nano"]);
    let folder = tempfile::tempdir().unwrap();
    let output = offline()
        .args(["detectors", "fetch", "yolox_nano", "--detectors"])
        .arg(folder.path())
        .output()
        .unwrap();
    assert_refused(&output, &["cannot reach raw.githubusercontent.com", "yolox_nano.onnx"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    std::fs::write(folder.path().join("yolox_nano.onnx"), b"something else").unwrap();
    let output = program()
        .args(["detectors", "check", "--detectors"])
        .arg(folder.path())
        .arg(&photo)
        .output()
        .unwrap();
    assert_refused(&output, &["is not the file yolox_nano was described with"]);
}

/// The program behind a proxy that does not answer.
fn offline() -> std::process::Command {
    let mut command = program();
    for name in ["HTTPS_PROXY", "https_proxy", "ALL_PROXY", "all_proxy"] {
        command.env(name, "http://127.0.0.1:9");
    }
    command.env_remove("NO_PROXY").env_remove("no_proxy");
    command
}

/// Detector, photo, and the "car" scores and boxes of the detector's own reference pipeline.
type Published = (&'static str, &'static str, &'static [(f64, [f64; 4])]);

#[rustfmt::skip]
const PUBLISHED: [Published; 10] = [
    ("yolox_nano", "darknet_dog.jpg", &[(0.798, [466.0, 78.0, 692.0, 171.0])]),
    ("nanodet_m", "darknet_dog.jpg", &[(0.459, [460.0, 77.0, 689.0, 166.0])]),
    ("fastestdet", "darknet_dog.jpg", &[(0.763, [457.0, 72.0, 703.0, 170.0])]),
    ("deimv2_femto", "darknet_dog.jpg", &[(0.671, [465.0, 77.0, 685.0, 171.0])]),
    ("deimv2_atto", "darknet_dog.jpg", &[(0.754, [465.0, 78.0, 692.0, 168.0])]),
    ("yolox_nano", "udacity_test1.jpg", &[(0.884, [1050.0, 404.0, 1275.0, 508.0]), (0.822, [813.0, 408.0, 943.0, 493.0])]),
    ("nanodet_m", "udacity_test1.jpg", &[(0.750, [813.0, 407.0, 943.0, 494.0]), (0.631, [1054.0, 406.0, 1277.0, 507.0])]),
    ("fastestdet", "udacity_test1.jpg", &[(0.863, [1035.0, 404.0, 1279.0, 511.0]), (0.817, [828.0, 416.0, 938.0, 494.0])]),
    ("deimv2_femto", "udacity_test1.jpg", &[(0.906, [1050.0, 403.0, 1272.0, 507.0]), (0.871, [812.0, 408.0, 945.0, 493.0])]),
    ("deimv2_atto", "udacity_test1.jpg", &[(0.875, [1050.0, 404.0, 1268.0, 509.0]), (0.868, [816.0, 409.0, 944.0, 494.0])]),
];

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn the_real_detectors_give_their_published_scores_and_boxes() {
    let weights = shared("detectors");
    let run = |photo: &Path| -> Vec<serde_json::Value> {
        let mut command = program();
        let output = command
            .args(["detectors", "check", "--json", "--detectors"])
            .arg(&weights)
            .arg(photo)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", common::stderr(&output));
        stdout(&output)
            .lines()
            .map(|l| serde_json::from_str(l).unwrap())
            .collect()
    };
    for photo in ["darknet_dog.jpg", "udacity_test1.jpg"] {
        let found = run(&shared(&format!("photos/cars/{photo}")));
        for (detector, _, cars) in PUBLISHED.iter().filter(|p| p.1 == photo) {
            let of_detector = found
                .iter()
                .filter(|l| l["detector"] == *detector && l["label"] == "car");
            for (line, (score, b)) in of_detector.zip(*cars) {
                let off = (line["score"].as_f64().unwrap() - score).abs();
                assert!(off < 0.02, "{detector} on {photo}: score off by {off}");
                let found: [f64; 4] = serde_json::from_value(line["box_px"].clone()).unwrap();
                for (found, wanted) in found.iter().zip(b) {
                    assert!(
                        (found - wanted).abs() <= 2.0,
                        "{detector} on {photo}: {found} instead of {wanted}"
                    );
                }
            }
            let count = found
                .iter()
                .filter(|l| l["detector"] == *detector && l["label"] == "car")
                .count();
            assert!(count >= cars.len(), "{detector} on {photo}: {count} cars");
        }
    }
}
