//! `advise` on the stored session, and where a session cannot tell; and `score --settings`.

use std::path::Path;
use std::process::Output;

use crate::common;

use common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr, stdout};
use serde_json::Value;

fn advise(session: &Path, out: &Path, more: &[&str]) -> Output {
    program()
        .arg("advise")
        .arg(session)
        .arg("-o")
        .arg(out)
        .args(more)
        .output()
        .unwrap()
}

#[test]
fn the_stored_session_is_scored_by_its_advice() {
    let out = tempfile::tempdir().unwrap();
    let output = advise(&skyline(), out.path(), &["--recorded"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let json = read_json(&out.path().join("advice.json"));
    let choices = json["poses"]["choices"].as_array().unwrap();
    for question in ["tag_detector", "solver", "camera_model", "tags", "resolution"] {
        let own: Vec<&Value> = choices.iter().filter(|choice| choice["question"] == question).collect();
        assert_eq!(
            own.iter().filter(|choice| choice["is_usual"] == true).count(),
            1,
            "{question}"
        );
        assert_eq!(
            own.iter().filter(|choice| choice["verdict"] == "advised").count(),
            1,
            "{question}: {own:?}"
        );
    }
    // A single tag is not enough where two are seen, and its photos are lost.
    let one = choices
        .iter()
        .find(|choice| choice["question"] == "tags" && choice["name"] == "1")
        .unwrap();
    assert!(one["verdict"] != "advised" && one["verdict"] != "enough", "{one}");
    let page = std::fs::read_to_string(out.path().join("advice.html")).unwrap();
    assert!(page.contains("What skyline needs") && page.contains("<svg") && page.contains("definition of AP"));
    assert!(stdout(&output).contains("← advised"), "{}", stdout(&output));

    let scored = |more: &[&str]| {
        let report = tempfile::tempdir().unwrap();
        let output = program()
            .arg("score")
            .arg(skyline())
            .args(["--recorded", "-o"])
            .arg(report.path())
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        read_json(&report.path().join("summary.json"))
    };
    let toml = out.path().join("advice.toml");
    let (usual, by_advice) = (scored(&[]), scored(&["--settings", toml.to_str().unwrap()]));
    let text = std::fs::read_to_string(&toml).unwrap();
    let named = text
        .lines()
        .find_map(|line| line.strip_prefix("tag_detector = \""))
        .unwrap()
        .trim_end_matches('"');
    let advised = choices
        .iter()
        .find(|choice| choice["question"] == "tag_detector" && choice["verdict"] == "advised")
        .unwrap();
    assert_eq!(advised["name"], named);
    for summary in [&usual, &by_advice] {
        assert_eq!(summary["photos_scored"], 16);
    }
    let rates = |summary: &Value| -> Vec<Value> {
        let results = summary["results"].as_array().unwrap();
        results
            .iter()
            .map(|result| result["overall"]["hit_rate"]["rate"].clone())
            .collect()
    };
    assert_eq!(rates(&usual), rates(&by_advice));

    // Another tag detector than the usual one is in the provenance, and a lens without its terms moves the poses.
    let other = out.path().join("other.toml");
    std::fs::write(&other, "tag_detector = \"apriltag\"\nlens_terms = 0\nap = \"voc-11\"\n").unwrap();
    let by_other = scored(&["--settings", other.to_str().unwrap()]);
    assert_ne!(
        by_other["provenance"]["tag_detector"],
        usual["provenance"]["tag_detector"]
    );
    assert_eq!(by_other["ap_definition"], "voc-11");
    let stated = &by_other["provenance"]["settings"];
    assert_eq!(
        (&stated["file"], &stated["lens_terms"]),
        (&"other.toml".into(), &0.into())
    );
    let cautions = by_other["cautions"].to_string();
    assert!(
        cautions.contains("without its lens model, as other.toml says"),
        "{cautions}"
    );
    assert!(usual["provenance"].get("settings").is_none());
}

fn keep_photos(session: &Path, first: usize) {
    let path = session.join("session.json");
    let mut file = read_json(&path);
    file["photos"].as_array_mut().unwrap().truncate(first);
    std::fs::write(&path, file.to_string()).unwrap();
}

/// A scene of one tag leaves none out; nothing is advised, and what would help is said.
#[test]
fn what_cannot_tell_says_so() {
    let session = copy_of_skyline();
    let scene = session.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let (head, tags) = text.split_at(text.find("[[tag]]").unwrap());
    let first = tags.split("[[tag]]").nth(1).unwrap();
    std::fs::write(&scene, format!("{head}[[tag]]{first}")).unwrap();
    keep_photos(session.path(), 6);
    let out = tempfile::tempdir().unwrap();
    let output = advise(session.path(), out.path(), &[]);
    let said = stdout(&output) + &stderr(&output);
    if output.status.success() {
        assert!(
            said.contains("no advice on poses") && said.contains("print more tags"),
            "{said}"
        )
    } else {
        assert_refused(&output, &["no photo of the session is located"])
    }

    // Two photos are too few for anything.
    let session = copy_of_skyline();
    keep_photos(session.path(), 2);
    let out = tempfile::tempdir().unwrap();
    let output = advise(session.path(), out.path(), &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("at least 6 are needed: take more photos"),
        "{}",
        stdout(&output)
    );
    // No number where nothing can be told.
    assert!(!stdout(&output).contains("← advised") && !stdout(&output).contains("held out °"));
    let page = std::fs::read_to_string(out.path().join("advice.html")).unwrap();
    assert!(page.contains("No advice on poses") && !page.contains("<table") && !page.contains("<svg"));
    let toml = std::fs::read_to_string(out.path().join("advice.toml")).unwrap();
    assert!(toml.lines().all(|line| line.starts_with('#')), "{toml}");
    // One texture has no drop.
    let refused = advise(session.path(), out.path(), &["--recorded"]);
    assert_refused(
        &refused,
        &["findings need photos of `normal` and of another texture", "has normal"],
    );

    let empty = tempfile::tempdir().unwrap();
    assert_refused(&advise(empty.path(), out.path(), &[]), &["no session.json"]);
}

#[test]
fn settings_that_are_none_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let toml = folder.path().join("own.toml");
    let out = folder.path().join("out");
    let score = |more: &[&str]| {
        let mut command = program();
        command
            .arg("score")
            .arg(skyline())
            .args(["--recorded", "--settings"])
            .arg(&toml)
            .arg("-o")
            .arg(&out);
        command.args(more).output().unwrap()
    };
    assert_refused(&score(&[]), &["own.toml"]);
    for (text, words) in [
        ("tag_detector = \"aprltag\"", &["own.toml", "aprltag"][..]),
        ("lens_terms = 9", &["`lens_terms` is 9", "0 to 8"]),
        ("ap = \"best\"", &["own.toml", "best"]),
        ("envelope = \"ball\"", &["own.toml", "`envelope` is \"ball\""]),
        ("tags = 3", &["own.toml", "tags"]),
        ("tag_detector", &["own.toml"]),
        ("\u{0}", &["own.toml"]),
    ] {
        std::fs::write(&toml, text).unwrap();
        assert_refused(&score(&[]), words);
    }
    std::fs::write(&toml, "ap = \"voc-11\"").unwrap();
    for ap in ["all-point", "coco-101"] {
        assert_refused(&score(&["--ap", ap]), &["voc-11", "leave one of them out"]);
    }
    assert_refused(&score(&["--shard", "1/2"]), &["--settings", "--shard"]);
    assert!(!out.exists());
}

/// A copy of the session whose scene names a mesh.
fn with_mesh(obj: &str) -> tempfile::TempDir {
    let copy = copy_of_skyline();
    let path = copy.path().join("scene.toml");
    let scene = std::fs::read_to_string(&path).unwrap();
    let scene = scene.replace("envelope = \"box\"", "envelope = \"mesh\"\nmesh = \"model.obj\"");
    std::fs::write(&path, scene).unwrap();
    std::fs::write(copy.path().join("model.obj"), obj).unwrap();
    copy
}

/// The drops of AP that `compare` finds, by detector.
fn drops(session: &Path) -> Vec<(String, f64)> {
    let out = tempfile::tempdir().unwrap();
    let output = program()
        .arg("compare")
        .arg(session)
        .args(["--recorded", "-o"])
        .arg(out.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let comparison = read_json(&out.path().join("comparison.json"));
    let results = comparison["results"].as_array().unwrap();
    results
        .iter()
        .map(|result| {
            let drop = result["ap50"]["drop"].as_f64().unwrap();
            (result["detector"].as_str().unwrap().to_owned(), drop)
        })
        .collect()
}

/// Whether the model's size is enough for truth boxes: it is for a model that is a box; what it moves is what `compare` finds with either; and `score` takes the advice.
#[test]
fn the_truth_boxes_that_are_enough_are_advised() {
    // The scene's size, 455.0 × 185.7 × 129.1 mm.
    let corner = |i: u32| {
        let side = |bit: u32, size: f64| if i >> bit & 1 == 1 { size / 2.0 } else { -size / 2.0 };
        format!(
            "v {} {} {}\n",
            side(0, 455.0),
            side(1, 185.7),
            side(2, 129.1) + 129.1 / 2.0
        )
    };
    let quads = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    let full: String = (0..8).map(corner).collect::<String>() + quads;
    // Touches each side of the box at its middle alone.
    let pointed = "v 227.5 0 64.55\nv -227.5 0 64.55\nv 0 92.85 64.55\nv 0 -92.85 64.55\nv 0 0 129.1\nv 0 0 0\n\
         f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    for (obj, is_enough) in [(full.as_str(), true), (pointed, false)] {
        let session = with_mesh(obj);
        let out = tempfile::tempdir().unwrap();
        let output = advise(session.path(), out.path(), &["--recorded"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let json = read_json(&out.path().join("advice.json"));
        let figures = &json["figures"];
        let by_box: Vec<&Value> = figures["rows"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|row| row["envelope"] == "box")
            .collect();
        let (by_mesh, as_box) = (drops(session.path()), drops(&skyline()));
        assert_eq!(by_box.len(), as_box.len());
        for ((row, mesh), expected) in by_box.iter().zip(&by_mesh).zip(&as_box) {
            assert_eq!(row["detector"], mesh.0);
            assert!(
                (row["drop"].as_f64().unwrap() - expected.1).abs() < 1e-9,
                "{row} {expected:?}"
            );
            let moved = row["moved_by"].as_f64().unwrap();
            assert!((moved - (expected.1 - mesh.1)).abs() < 1e-9, "{row}");
            let interval = &row["moved_by_95"];
            assert!(
                interval.is_null()
                    || interval["low"].as_f64() <= Some(moved) && Some(moved) <= interval["high"].as_f64()
            );
        }
        assert_eq!(figures["box_is_enough"], is_enough, "{figures}");
        let toml = out.path().join("advice.toml");
        let text = std::fs::read_to_string(&toml).unwrap();
        assert_eq!(text.contains("\nenvelope = \"box\""), is_enough, "{text}");
        if !is_enough {
            assert!(
                stdout(&output).contains("the model's outline is needed"),
                "{}",
                stdout(&output)
            );
            continue;
        }
        let report = tempfile::tempdir().unwrap();
        let output = program()
            .arg("score")
            .arg(session.path())
            .args(["--recorded", "--settings"])
            .arg(&toml)
            .arg("-o")
            .arg(report.path())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let summary = read_json(&report.path().join("summary.json"));
        assert_eq!(summary["provenance"]["sessions"][0]["truth_envelope"], "box");
        assert!(
            summary["cautions"]
                .to_string()
                .contains("truth boxes are by the model's size, as advice.toml says")
        );
    }
}
