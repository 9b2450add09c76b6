//! `attack judge`: what is printed is what a run's own judging says, of all views.

use crate::common;

use common::{assert_refused, home, program, shared};
use scaleproof_surface::pattern::Pattern;
use serde_json::Value;

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn patterns_are_judged_on_every_view_beside_the_plain_model() {
    let detectors = shared("detectors");
    let out = tempfile::tempdir().unwrap();
    let random = out.path().join("random.png");
    Pattern::random(16, 1).unwrap().cells().save(&random).unwrap();
    let judge = |arguments: &[&str]| {
        let mut command = program();
        command
            .args(["attack", "judge"])
            .arg(home().join("captures/skyline_attack"));
        command.arg("--detectors").arg(&detectors).args(arguments);
        command.output().unwrap()
    };
    let attack = home().join("print_templates/patterns/yolox_nano_attack_1.png");
    let patterns = [
        format!("attack={}", attack.display()),
        format!("random={}", random.display()),
    ];
    let asked = [
        "--detector",
        "yolox_nano,fastestdet",
        "--pattern",
        &patterns[0],
        &patterns[1],
    ];
    let output = judge(&[&asked[..], &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["views"], 12);
    // As its card says; the random one has no card, and is repeated as often.
    assert_eq!(json["tile_mm"], serde_json::json!({"attack": 240.0, "random": 240.0}));
    let rows = json["results"].as_array().unwrap();
    let of = |detector: &str, pattern: &str| {
        let found = rows
            .iter()
            .find(|row| row["detector"] == detector && row["pattern"] == pattern);
        found.unwrap_or_else(|| panic!("{detector} {pattern}: {json}"))
    };
    assert_eq!(rows.len(), 6);
    let (plain, attack) = (of("yolox_nano", "808080"), of("yolox_nano", "attack"));
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap();
    assert_eq!(number(plain, "drop"), 0.0);
    assert!(number(attack, "ap50") < 0.5 * number(plain, "ap50"), "{json}");
    let difference = number(plain, "mean_confidence") - number(attack, "mean_confidence");
    assert!((number(attack, "drop") - difference).abs() < 1e-12);
    let [low, high] = [0, 1].map(|i| attack["drop_95"][i].as_f64().unwrap());
    assert!(0.0 < low && low < difference && difference < high, "{attack}");
    for row in rows {
        let worst = &row["worst_direction"];
        assert!(
            number(worst, "mean_confidence") >= number(row, "mean_confidence") - 1e-12,
            "{row}"
        );
        assert_eq!(number(worst, "azimuth_deg") % 45.0, 0.0);
    }
    // The table says the same.
    let text = String::from_utf8(judge(&asked).stdout).unwrap();
    let line = text
        .lines()
        .find(|line| line.starts_with("yolox_nano") && line.contains("attack"))
        .unwrap();
    assert!(
        line.contains(&format!("{:.2} [{low:.2}, {high:.2}]", difference)),
        "{text}"
    );
    assert!(text.contains("on 12 views, tile 240 mm"), "{text}");
    // Each pattern is repeated as its own card says.
    let other = home().join("print_templates/patterns/yolox_nano_118mm_1.png");
    let other = format!("other={}", other.display());
    let several = judge(&["--detector", "yolox_nano", "--json", "--pattern", &patterns[0], &other]);
    let several: Value = serde_json::from_slice(&several.stdout).unwrap();
    assert_eq!(several["tile_mm"], serde_json::json!({"attack": 240.0, "other": 118.0}));
    let names = several["results"].as_array().unwrap().iter().map(|row| &row["pattern"]);
    assert_eq!(names.collect::<Vec<_>>(), ["808080", "attack", "other"]);
    assert_eq!(several["results"][1]["drop"], attack["drop"]);
    // What cannot be judged.
    std::fs::write(random.with_extension("json"), "{").unwrap();
    assert_refused(
        &judge(&["--pattern", &patterns[1]]),
        &["random.json is no card", "give --tile-mm"],
    );
    assert_refused(
        &judge(&["--tile-mm", "118", "--pattern", &patterns[1], &patterns[1]]),
        &["`random` is named twice"],
    );
    let frames = home().join("captures/skyline_attack");
    let frames = frames.to_str().unwrap();
    assert_refused(
        &judge(&[frames, "--pattern", &patterns[0]]),
        &["are the same frames", "name them once"],
    );
    assert_refused(&judge(&["--pattern", "missing.png"]), &["missing.png"]);
    let small = out.path().join("small.png");
    Pattern::random(8, 1).unwrap().cells().save(&small).unwrap();
    let small = format!("small={}", small.display());
    assert_refused(
        &judge(&["--pattern", &patterns[0], &small]),
        &["small.png has 8×8 cells", "16×16", "patterns of one size"],
    );
    assert_refused(
        &judge(&["--laying", "sides", "--pattern", &small]),
        &["small.png has 8×8 cells", "8×48", "--laying sides"],
    );
    assert_refused(
        &judge(&["--normal", "grey", "--pattern", &patterns[0]]),
        &["grey", "808080"],
    );
}

#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn a_finished_pattern_keeps_the_width_of_its_repeat() {
    let detectors = shared("detectors");
    let out = tempfile::tempdir().unwrap();
    let import = |more: &[&str]| {
        let mut command = program();
        command.args(["attack", "baseline", "import"]);
        command.arg(home().join("captures/skyline_attack")).arg("--pattern");
        command.arg(home().join("print_templates/patterns/yolox_nano_er.png"));
        command.arg("--detectors").arg(&detectors).args(more);
        command.arg("-o").arg(out.path()).output().unwrap()
    };
    for (more, tile_mm) in [(&[][..], 240.0), (&["--tile-mm", "118"], 118.0)] {
        let output = import(more);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let card = common::read_json(&out.path().join("pattern.json"));
        assert_eq!((&card["tile_mm"], &card["classes"]), (&tile_mm.into(), &"car".into()));
    }
    // Its cells are its own.
    assert!(import(&["--cells", "16"]).status.success());
    assert_refused(
        &import(&["--cells", "24"]),
        &[
            "yolox_nano_er.png has 16×16 cells",
            "--cells is 24",
            "leave --cells out",
        ],
    );
    // What another method found is not replaced.
    let before = std::fs::read(out.path().join("pattern.png")).unwrap();
    let mut flat = program();
    flat.args(["attack", "baseline", "flat", "--flat", "808080"]);
    flat.arg(home().join("captures/skyline_attack"));
    flat.arg("--detectors").arg(&detectors).arg("-o").arg(out.path());
    assert_refused(
        &flat.output().unwrap(),
        &["holds what import made", "another folder for flat"],
    );
    // Nor what nobody knows.
    std::fs::remove_file(out.path().join("history.json")).unwrap();
    assert_refused(&import(&[]), &["a pattern without its history", "another folder"]);
    assert_eq!(std::fs::read(out.path().join("pattern.png")).unwrap(), before);
}
