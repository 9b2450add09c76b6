//! Programs that give gradients: the attack follows them as it follows a network, and what is wrong with a gradient is said before anything is moved.
//! The programs are Python without packages; their loss is a formula.

use crate::common;

use std::path::Path;
use std::process::{Command, Output};

use common::{HANG, assert_refused, home, program, read_json, stderr};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{Manifest, ProgramDetector, ProgramSpec};
use scaleproof_gradients::program::ProgramWhiteBox;
use scaleproof_gradients::{Boxes, WhiteBox};

/// C = σ(z), z = 30 · Σ w · (value − 0.5) / values, so that −ln(1 − C) = ln(1 + e^z). Its one box is at 10, 10, 86, 54.
const WEAVE: &str = r#"
import array, json, math, os, sys
fault = sys.argv[1]
hello = {"scaleproof_detector": 1, "name": "weave", "version": "1", "labels": ["car", "van"], "input": "rgb", "gradients": True}
if fault == "no gradients":
    del hello["gradients"]
if fault.startswith("partial"):
    hello["gradients"] = "partial"
if fault == "paths":
    hello["input"] = "path"
print(json.dumps(hello), flush=True)
asked = 0
for line in sys.stdin.buffer:
    request = json.loads(line)
    data = sys.stdin.buffer.read(request["bytes"])
    differentiates = request["task"] == "loss_and_gradient"
    values = array.array("f" if differentiates else "B", data)
    scale = 1 if differentiates else 255
    weights = [math.sin(0.37 * (i // 3) + i % 3) + 0.4 for i in range(len(values))]
    z = 30 * sum(w * (v / scale - 0.5) for w, v in zip(weights, values)) / len(values)
    box = [10, 10, 86, 54]
    if not differentiates:
        found = [{"label": "car", "score": 1 / (1 + math.exp(-z)), "box": box}]
        print(json.dumps({"id": request["id"], "detections": found}), flush=True)
        continue
    if fault == "error":
        print(json.dumps({"id": request["id"], "error": "out of memory"}), flush=True)
        continue
    inner = max(0, min(86, request["box"][2]) - max(10, request["box"][0])) * max(0, min(54, request["box"][3]) - max(10, request["box"][1]))
    outer = 76 * 44 + (request["box"][2] - request["box"][0]) * (request["box"][3] - request["box"][1]) - inner
    if inner < request["least_iou"] * outer or request["labels"] != [0] or fault == "blind":
        print(json.dumps({"id": request["id"], "loss": None}), flush=True)
        continue
    asked += 1
    loss = math.log1p(math.exp(z)) * (1 + 0.02 * (asked % 2) if fault == "training" else 1)
    slope = 30 / (1 + math.exp(-z)) / len(values)
    gradient = [slope * w for w in weights]
    factor = {"partial sign": -1, "sign": -1, "scale": 3, "255": 1 / 255, "zero": 0, "sign and scale": -0.5}.get(fault, 1)
    gradient = [factor * g for g in gradient]
    shape = [request["height"], request["width"], 3]
    if fault == "channels":
        gradient = [g for i in range(0, len(gradient), 3) for g in gradient[i : i + 3][::-1]]
    elif fault in ("half", "partial"):
        gradient[len(gradient) // 2 :] = [0] * (len(gradient) - len(gradient) // 2)
    elif fault == "NaN":
        gradient[3 * 97 + 1] = math.nan
    elif fault == "shape":
        shape = [3, request["height"], request["width"]]
    elif fault == "NaN loss":
        loss = math.nan
    elif fault == "negative":
        loss = -loss
    sys.stdout.write(json.dumps({"id": request["id"], "loss": loss, "shape": shape}) + "\n")
    sys.stdout.flush()
    if fault == "dies":
        sys.exit("no memory left")
    if fault == "hangs":
        import time
        time.sleep(1000)
    sys.stdout.buffer.write(array.array("f", gradient).tobytes())
    sys.stdout.flush()
"#;

fn weave(folder: &Path, fault: &str) -> String {
    let python = Command::new("python3").arg("--version").output();
    assert!(python.is_ok_and(|o| o.status.success()), "this test needs python3");
    let path = folder.join("weave.py");
    std::fs::write(&path, WEAVE).unwrap();
    format!("exec:python3 {} '{fault}'", path.display())
}

fn attacked(folder: &Path, fault: &str, more: &[&str]) -> Output {
    let mut command = program();
    command
        .args(["attack", "run"])
        .arg(home().join("captures/skyline_frames"))
        .args([
            "--detector",
            &weave(folder, fault),
            "--cells",
            "6",
            "--steps",
            "4",
            "--quiet",
            "-o",
        ])
        .arg(folder.join("out"))
        .args(more);
    command.output().unwrap()
}

#[test]
fn losses_and_gradients_are_those_of_the_formula() {
    let folder = tempfile::tempdir().unwrap();
    let spec = ProgramSpec::named(&weave(folder.path(), "")).unwrap().unwrap();
    let detector = ProgramDetector::open(spec, HANG).unwrap();
    let manifest = Manifest::of_foreign(detector.card());
    let detector = ProgramWhiteBox::open(detector, manifest, vec![0], true).unwrap();
    let (width, height) = (96, 64);
    let image: Vec<[f64; 3]> = (0..width * height)
        .map(|i| [0, 1, 2].map(|c| 0.5 + 0.3 * (0.11 * i as f64 + c as f64).sin()))
        .collect();
    let weight = |i: usize, c: usize| (0.37 * i as f64 + c as f64).sin() + 0.4;
    let values = (3 * width * height) as f64;
    let z: f64 = (0..image.len())
        .flat_map(|i| [0, 1, 2].map(|c| weight(i, c) * (image[i][c] - 0.5)))
        .sum::<f64>()
        * 30.0
        / values;
    let outline = BoxPx::new(12.0, 8.0, 84.0, 54.0);
    let size = [width as u32, height as u32];
    let found = detector
        .loss_and_gradient(&image, size, &outline, Boxes::Strongest)
        .unwrap()
        .unwrap();
    let confidence = 1.0 / (1.0 + (-z).exp());
    assert!((found.loss - z.exp().ln_1p()).abs() < 1e-6, "{} {z}", found.loss);
    assert!((found.confidence - confidence).abs() < 1e-6);
    for i in [0, 95, 96, 3000, 6143] {
        for c in 0..3 {
            let expected = 30.0 * confidence * weight(i, c) / values;
            assert!((found.gradient[i][c] - expected).abs() < 1e-9, "{i} {c}");
        }
    }
    let far = BoxPx::new(70.0, 40.0, 95.0, 63.0);
    assert_eq!(
        detector
            .loss_and_gradient(&image, size, &far, Boxes::Strongest)
            .unwrap(),
        None
    );
    // Rounded to 8 bits it sees about the same.
    let predicted = detector.predictions(&image, size).unwrap();
    assert_eq!(predicted.len(), 1);
    assert!((predicted[0].confidence - confidence).abs() < 1e-3);
    assert_eq!(predicted[0].box_px, BoxPx::new(10.0, 10.0, 86.0, 54.0));
}

#[test]
fn a_pattern_is_made_against_a_program() {
    let folder = tempfile::tempdir().unwrap();
    let mut patterns = Vec::new();
    for _ in 0..2 {
        let output = attacked(folder.path(), "", &["--batch", "2", "--rate", "0.1"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let history = read_json(&folder.path().join("out/history.json"));
        let losses: Vec<f64> = (0..4)
            .map(|i| history["entries"][i]["loss"].as_f64().unwrap())
            .collect();
        assert!(losses[3] < 0.9 * losses[0], "{losses:?}");
        assert!(history["detectors"][0].as_str().unwrap().starts_with("weave "));
        patterns.push(std::fs::read(folder.path().join("out/pattern.png")).unwrap());
        std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    }
    assert!(patterns[0] == patterns[1], "the same input gives the same bytes");
    // A gradient that leaves out a part, and says so, is followed.
    let output = attacked(folder.path(), "partial", &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    // A search needs boxes alone.
    let output = program()
        .args(["attack", "baseline", "er"])
        .arg(home().join("captures/skyline_frames"))
        .args(["--detector", &weave(folder.path(), "no gradients")])
        .args(["--cells", "6", "--queries", "20", "-o"])
        .arg(folder.path().join("er"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("nothing was searched"), "{}", stderr(&output));
}

#[test]
fn a_wrong_gradient_ends_the_attack_with_one_sentence() {
    for (fault, words) in [
        ("sign", &["its gradient has the wrong sign"][..]),
        ("scale", &["wrong scale: it is 3.00"]),
        ("sign and scale", &["wrong scale, and the wrong sign: it is -0.50"]),
        ("255", &["wrong scale: values go from 0 to 1 here, and not to 255"]),
        ("partial sign", &["its gradient has the wrong sign"]),
        ("zero", &["its gradient is 0 at every pixel"]),
        ("channels", &["its gradient is not the derivative of its loss"]),
        ("half", &["its gradient is not the derivative of its loss"]),
        ("training", &["asked again", "is it set to training"]),
        ("NaN", &["its gradient is NaN at pixel x 1, y 1"]),
        ("NaN loss", &["it has NaN where a number belongs"]),
        ("negative", &["its loss is -"]),
        (
            "shape",
            &[
                "the shape [3, 64, 96], and the image has [64, 96, 3]",
                "channels come last",
            ],
        ),
        ("error", &["weave gives no answer: out of memory"]),
        ("dies", &["ended with exit code 1", "its last words: no memory left"]),
        ("hangs", &["has not said anything within 2 s", "--detector-timeout"]),
        ("no gradients", &["weave gives no gradients"]),
        ("paths", &["gradients need pixels: its input must be \"rgb\""]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let limit = if fault == "hangs" { "2" } else { "60" };
        assert_refused(&attacked(folder.path(), fault, &["--detector-timeout", limit]), words);
        assert!(!folder.path().join("out/pattern.png").exists(), "{fault}");
    }
}
