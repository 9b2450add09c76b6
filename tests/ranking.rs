//! `score --ranking`: whether the order of the textures holds in other sessions, against orders made by hand.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common;

use common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr, stdout};
use serde_json::{Value, json};

/// The stored photos at two places as three textures: `a` plain, `b` patterned, `c` plain in the first directions and patterned in the others. What each is called is `names`.
fn session(names: [&str; 3]) -> tempfile::TempDir {
    let folder = copy_of_skyline();
    let file = read_json(&folder.path().join("session.json"));
    let of = |variant: &str| -> Vec<String> {
        let own = file["photos"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|p| p["variant"] == variant);
        own.map(|p| p["file"].as_str().unwrap().to_owned()).collect()
    };
    let (plain, patterned) = (of("normal"), of("random"));
    let mixed = [&plain[..5], &patterned[5..]].concat();
    let mut photos = Vec::new();
    for place in ["meadow", "garage"] {
        for (name, files) in names.iter().zip([&plain, &patterned, &mixed]) {
            for file in files {
                // A session lists no file twice; the recordings know photos by their content.
                let copy = format!("{place}_{name}_{file}");
                std::fs::copy(folder.path().join(file), folder.path().join(&copy)).unwrap();
                photos.push(json!({"file": copy, "variant": name, "place": place}));
            }
        }
    }
    let session = json!({"scene": "scene.toml", "camera": "camera.yaml", "photos": photos});
    std::fs::write(folder.path().join("session.json"), session.to_string()).unwrap();
    folder
}

struct Scored {
    folder: tempfile::TempDir,
    output: Output,
}

fn score(session: &Path, others: &[&Path], more: &[&str]) -> Scored {
    let folder = tempfile::tempdir().unwrap();
    let mut command = program();
    command
        .arg("score")
        .arg(session)
        .args(["--recorded", "-o"])
        .arg(folder.path())
        .args(more);
    if !others.is_empty() {
        command.arg("--ranking").args(others);
    }
    let output = command.output().unwrap();
    Scored { folder, output }
}

impl Scored {
    fn summary(&self) -> Value {
        assert!(self.output.status.success(), "{}", stderr(&self.output));
        read_json(&self.folder.path().join("summary.json"))
    }
}

fn row<'a>(summary: &'a Value, detector: &str, photos: &str) -> &'a Value {
    let rows = summary["ranking"]["rows"].as_array().unwrap();
    rows.iter()
        .find(|row| row["detector"] == detector && row["photos"] == photos)
        .unwrap()
}

/// AP by texture, from the table of results.
fn aps(summary: &Value, detector: &str) -> Vec<(String, f64)> {
    let own = summary["results"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|r| r["detector"] == detector);
    own.map(|r| {
        (
            r["variant"].as_str().unwrap().to_owned(),
            r["overall"]["ap50"].as_f64().unwrap(),
        )
    })
    .collect()
}

const FEMTO: [&str; 4] = ["--detector", "deimv2_femto", "--base", "a"];

#[test]
fn the_same_order_holds_and_an_exchanged_one_does_not() {
    let own = session(["a", "b", "c"]);
    let alone = score(own.path(), &[], &FEMTO).summary();
    let mut ap = aps(&alone, "deimv2_femto");
    ap.sort_by(|x, y| y.1.total_cmp(&x.1));
    let order: Vec<&str> = ap.iter().map(|(variant, _)| variant.as_str()).collect();
    assert_eq!(order, ["a", "c", "b"], "the case has changed: {ap:?}");
    assert_eq!(alone["ranking"], Value::Null);

    // (names in the other session, τ by hand): of three pairs of textures, none, all or one is the other way round.
    for (names, tau, finding) in [
        (["a", "b", "c"], 1.0, "holds"),
        (["b", "a", "c"], -1.0, ""),
        // Two in common, which no resampling takes for each other.
        (["b", "a", "x"], -1.0, "reversed"),
        (["a", "c", "b"], 1.0 / 3.0, ""),
    ] {
        let other = session(names);
        let scored = score(own.path(), &[other.path()], &FEMTO);
        let summary = scored.summary();
        let row = row(&summary, "deimv2_femto", "all");
        assert!((row["tau"].as_f64().unwrap() - tau).abs() < 1e-9, "{names:?}: {row}");
        assert!(finding.is_empty() || row["finding"] == finding, "{names:?}: {row}");
        assert_eq!((&row["cells"], &row["clusters"]), (&json!([16, 16]), &json!([16, 16])));
        let listed = row["variants"].as_array().unwrap();
        let here: Vec<(String, f64)> = listed
            .iter()
            .map(|v| (v["variant"].as_str().unwrap().to_owned(), v["ap50"].as_f64().unwrap()))
            .collect();
        let common: Vec<(String, f64)> = ap
            .iter()
            .filter(|(name, _)| names.contains(&name.as_str()))
            .cloned()
            .collect();
        assert_eq!(here, common);
        let there = aps(&score(other.path(), &[], &FEMTO).summary(), "deimv2_femto");
        for variant in listed {
            let same = there
                .iter()
                .find(|(name, _)| variant["variant"] == name.as_str())
                .unwrap();
            assert_eq!(variant["other_ap50"], same.1);
        }
        if let (Some(low), Some(high)) = (row["interval_95"]["low"].as_f64(), row["interval_95"]["high"].as_f64()) {
            assert!(low <= tau + 1e-9 && tau <= high + 1e-9, "{row}");
        }
        let page = std::fs::read_to_string(scored.folder.path().join("report.html")).unwrap();
        assert!(page.contains("Order of the textures in other sessions") && page.contains("Kendall"));
        assert!(
            stdout(&scored.output).contains("Order of the textures by AP@0.5"),
            "{}",
            stdout(&scored.output)
        );
    }
}

#[test]
fn orders_of_groups_and_what_cannot_be_held_against_each_other() {
    let own = session(["a", "b", "c"]);
    let grouped = score(
        own.path(),
        &[own.path()],
        &[&FEMTO[..], &["--group-by", "place,distance"]].concat(),
    )
    .summary();
    for photos in ["all", "place meadow", "place garage", "distance 850"] {
        assert_eq!(row(&grouped, "deimv2_femto", photos)["tau"], 1.0, "{photos}");
    }
    // Other names: no texture in common but the base.
    let other = session(["a", "x", "y"]);
    let scored = score(own.path(), &[other.path()], &FEMTO);
    let summary = scored.summary();
    assert_eq!(summary["ranking"]["rows"], json!([]));
    assert!(
        stdout(&scored.output).contains("1 texture in common, and an order needs two"),
        "{}",
        stdout(&scored.output)
    );
    // Two textures of eight directions each, that the detectors hardly tell apart: no answer.
    let stored = score(&skyline(), &[&skyline()], &["--detector", "yolox_nano"]).summary();
    let row = row(&stored, "yolox_nano", "all");
    assert_eq!(
        (&row["tau"], &row["finding"]),
        (&json!(1.0), &json!("too_few_photos_to_tell")),
        "{row}"
    );
}

#[test]
fn what_is_no_session_is_one_sentence() {
    let empty = tempfile::tempdir().unwrap();
    let missing = PathBuf::from("nowhere");
    assert_refused(&score(&skyline(), &[&missing], &[]).output, &["nowhere"]);
    assert_refused(&score(&skyline(), &[empty.path()], &[]).output, &["no session.json"]);
    assert_refused(
        &score(&skyline(), &[&skyline()], &["--shard", "1/2"]).output,
        &["--ranking", "--shard"],
    );
}
