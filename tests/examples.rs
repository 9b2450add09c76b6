//! The programs in `examples/`: what a Rust program needs is public, and does what their first lines say.

use std::path::{Path, PathBuf};
use std::process::Command;

fn home() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What an example prints; cargo has built it beside the program.
fn run(name: &str, arguments: &[&Path]) -> String {
    let example = Path::new(env!("CARGO_BIN_EXE_scaleproof"))
        .with_file_name("examples")
        .join(name);
    let output = Command::new(example).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_photo_is_located_where_the_session_s_truth_says() {
    let skyline = home().join("captures/skyline");
    let truth = std::fs::read_to_string(skyline.join("truth.json")).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
    let photo = &truth["photos"][1];
    let file = skyline.join(photo["file"].as_str().unwrap());
    let said = run(
        "locate_a_photo",
        &[&file, &skyline.join("scene.toml"), &skyline.join("camera.yaml")],
    );
    let azimuth: f64 = said
        .split_whitespace()
        .nth(1)
        .unwrap()
        .trim_end_matches('°')
        .parse()
        .unwrap();
    assert!(
        (azimuth - photo["azimuth_deg"].as_f64().unwrap()).abs() < 0.02,
        "{said}"
    );
}

#[test]
fn a_session_is_scored_and_compared() {
    let folder = tempfile::tempdir().unwrap();
    let said = run("score_a_session", &[&scaleproof_testing::skyline(), folder.path()]);
    for detector in ["yolox_nano", "nanodet_m", "fastestdet", "deimv2_femto", "deimv2_atto"] {
        assert!(
            said.contains(&format!("{detector} random: hit rate lower by ")),
            "{said}"
        );
    }
    let summary = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["photos_scored"], 16);
}

#[test]
fn a_template_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let template: PathBuf = folder.path().join("template.pdf");
    let said = run(
        "print_a_template",
        &[&home().join("print_templates/random16.png"), &template],
    );
    // Instructions, and three sheets by two.
    assert_eq!(said, "7 pages\n");
    assert_eq!(lopdf::Document::load(template).unwrap().get_pages().len(), 7);
}

#[test]
fn each_is_short() {
    for entry in std::fs::read_dir(home().join("examples")).unwrap() {
        let path = entry.unwrap().path();
        let lines = std::fs::read_to_string(&path).unwrap().lines().count();
        assert!(lines < 60, "{} has {lines} lines", path.display());
    }
}
