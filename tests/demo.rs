//! The demo, as a new user meets it: without weights and network, and with weights.

use crate::common;

use std::path::Path;
use std::process::Command;

use common::{home, program, read_json, shared, stderr, stdout, stored};
use scaleproof_core::files::sha256_hex;

const TITLES: [&str; 5] = [
    "YOLOX-Nano 416",
    "NanoDet-m 416",
    "FastestDet 352",
    "DEIMv2-Femto 416",
    "DEIMv2-Atto 320",
];

fn demo(command: &mut Command, out: &Path) -> String {
    let output = command.arg("demo").arg("--out").arg(out).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

fn assert_complete(text: &str, out: &Path) {
    let lines: Vec<&str> = text.trim_end().lines().collect();
    assert!(
        lines[0].starts_with("24 of 24 renders of a 1:10 car are located by their tags: "),
        "{text}"
    );
    let found = "In the same light, “two_targets” hides the model from 1 of 5 detectors and weakens 4";
    let found = lines.iter().position(|line| *line == found).unwrap();
    assert!(
        lines[found + 1].starts_with("These photos are renders: 8 pairs"),
        "{text}"
    );
    let head = lines.iter().position(|line| line.starts_with("detector ")).unwrap();
    for (rows, title) in lines[head + 1..].chunks(2).zip(TITLES) {
        assert!(rows[0].starts_with(title) && rows[0].contains(" random "), "{text}");
        assert!(rows[1].starts_with("  ") && rows[1].contains(" two_targets "), "{text}");
    }
    assert!(lines[head..].iter().all(|line| line.chars().count() <= 100), "{text}");
    assert!(lines.len() <= 26, "no screen holds it: {text}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("1:10 model of a car · 24 renders · "));
    for (file, start) in [
        ("report.html", "<!DOCTYPE html>"),
        ("template.pdf", "%PDF-"),
        ("summary.json", "{"),
    ] {
        let bytes = std::fs::read(out.join(file)).unwrap();
        assert!(bytes.starts_with(start.as_bytes()), "{file}");
    }
    assert!(text.contains(&out.join("report.html").display().to_string()));
    assert!(text.contains(&out.join("template.pdf").display().to_string()));
}

#[test]
fn without_weights_and_network_it_plays_back_and_runs_the_project_s_own_detector() {
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command.env("XDG_CACHE_HOME", out.path().join("cache"));
    for name in ["HTTPS_PROXY", "https_proxy", "ALL_PROXY", "all_proxy"] {
        command.env(name, "http://127.0.0.1:9");
    }
    command.env_remove("NO_PROXY").env_remove("no_proxy");
    let text = demo(&mut command, out.path());
    assert_complete(&text, out.path());
    assert!(
        text.contains("detections RECORDED, not found by running: yolox_nano, nanodet_m"),
        "{text}"
    );
    assert!(
        text.contains("because cannot reach raw.githubusercontent.com"),
        "{text}"
    );
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Recorded detections: these did not run for this report"));
    assert!(text.contains("running: scaleproof_car"), "{text}");
    assert_eq!(text.matches(" not tested ").count(), 2, "{text}");
    let row = text
        .lines()
        .find(|line| line.starts_with("scaleproof car 256"))
        .unwrap();
    assert!(
        row.contains(" 8 → 7 of 8"),
        "all plain cars of the stored session are found: {row}"
    );
    let summary = read_json(&out.path().join("summary.json"));
    let sources: Vec<_> = summary["provenance"]["detectors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|d| &d["source"])
        .collect();
    assert_eq!(
        sources.iter().filter(|source| **source == "live").count(),
        1,
        "{sources:?}"
    );
}

#[test]
fn without_onnx_runtime_it_plays_back_too() {
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command.env("ORT_DYLIB_PATH", out.path().join("no-such-library.so"));
    let text = demo(&mut command, out.path());
    assert_complete(&text, out.path());
    assert!(text.contains("because ONNX Runtime was not found"), "{text}");
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("Recorded detections: no detector ran for this report"));
}

/// The stored session is found, and ONNX Runtime is looked for where nothing names it.
#[test]
fn variables_that_are_set_to_nothing_count_as_unset() {
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    for name in [
        "ORT_DYLIB_PATH",
        "SCALEPROOF_DETECTORS",
        "SCALEPROOF_HOME",
        "SCALEPROOF_SHARED",
    ] {
        command.env(name, "");
    }
    let text = demo(&mut command, out.path());
    assert_complete(&text, out.path());
    assert!(!text.contains("ONNX Runtime was not found (:"), "{text}");
}

/// The pattern that the stored photos show stays in the repository as long as they are of it.
#[test]
fn the_pattern_that_the_demo_wears_is_there() {
    let session = read_json(&stored().join("session.json"));
    let photos = session["photos"].as_array().unwrap();
    assert_eq!(
        photos.iter().filter(|photo| photo["variant"] == "two_targets").count(),
        8
    );
    let pattern = std::fs::read(home().join("print_templates/patterns/two_targets_1.png")).unwrap();
    let readme = std::fs::read_to_string(stored().join("README.md")).unwrap();
    let rendered = format!(
        "`print_templates/patterns/two_targets_1.png` (SHA-256 `{}`)",
        sha256_hex(&pattern)
    );
    assert!(readme.contains(&rendered), "{rendered}");
}

#[test]
fn for_programs_it_names_what_it_made() {
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command.env("ORT_DYLIB_PATH", out.path().join("no-such-library.so"));
    let output = command.args(["demo", "--json", "-o"]).arg(out.path()).output().unwrap();
    let made: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    for (key, start) in [
        ("pattern", &b"\x89PNG"[..]),
        ("template", b"%PDF-"),
        ("report", b"<!DOCTYPE html>"),
        ("summary", b"{"),
    ] {
        let bytes = std::fs::read(made[key].as_str().unwrap()).unwrap();
        assert!(bytes.starts_with(start), "{key}");
    }
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn with_weights_it_runs_the_detectors() {
    let weights = shared("detectors");
    let out = tempfile::tempdir().unwrap();
    let text = demo(program().env("SCALEPROOF_DETECTORS", weights), out.path());
    assert_complete(&text, out.path());
    assert!(!text.contains("RECORDED"), "{text}");
    let summary = read_json(&out.path().join("summary.json"));
    assert!(
        summary["provenance"]["detectors"]
            .as_array()
            .unwrap()
            .iter()
            .all(|d| d["source"] == "live")
    );
    assert!(
        summary["provenance"]["onnx_runtime"]
            .as_str()
            .unwrap()
            .contains("onnxruntime")
    );
}

/// The whole way from stored frames to a lower score runs with nothing but the clone.
#[test]
fn the_attack_s_demo_runs_the_project_s_own_detector_where_no_weights_are() {
    let out = tempfile::tempdir().unwrap();
    let output = program()
        .args(["attack", "demo", "-o"])
        .arg(out.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(
        text.contains("scaleproof_car.toml looks at the held-out views"),
        "{text}"
    );
    let confidence = |pattern: &str| -> f64 {
        let row = text.lines().find(|line| line.starts_with(pattern)).unwrap();
        row.split_whitespace().last().unwrap().parse().unwrap()
    };
    let [random, attack] = ["random", "attack"].map(confidence);
    assert!(attack < random - 0.1, "{text}");
}
