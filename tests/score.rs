//! `score` on the stored session: figures against pycocotools and by hand, recorded against live, and bad input.

mod common;

use std::path::Path;
use std::process::Output;

use common::{assert_refused, copy_of_skyline, program, read_json, shared, skyline, stderr, stdout};
use scaleproof::geometry::BoxPx;
use serde_json::Value;

fn score(session: &Path, out: &Path, more: &[&str]) -> Output {
    program()
        .arg("score")
        .arg(session)
        .arg("--out")
        .arg(out)
        .args(more)
        .output()
        .unwrap()
}

fn recorded(session: &Path, out: &Path) -> Output {
    score(session, out, &["--recorded"])
}

fn result<'a>(summary: &'a Value, detector: &str, variant: &str) -> &'a Value {
    let results = summary["results"].as_array().unwrap();
    results
        .iter()
        .find(|r| r["detector"] == detector && r["variant"] == variant)
        .unwrap()
}

/// (photo file, verdict) of one detector from photos.csv.
fn rows(out: &Path) -> Vec<csv::StringRecord> {
    csv::Reader::from_path(out.join("photos.csv"))
        .unwrap()
        .records()
        .map(Result::unwrap)
        .collect()
}

/// AP@0.5 that pycocotools 2.0.11 gives for `coco_truth.json` and `coco_results_*.json` of the recorded session, with the
/// variant's photos as `imgIds`.
const BY_PYCOCOTOOLS: [(&str, f64, f64); 5] = [
    ("yolox_nano", 0.8712871287128713, 0.7322360807509322),
    ("nanodet_m", 0.8712871287128713, 0.8712871287128713),
    ("fastestdet", 1.0, 0.9207920792079208),
    ("deimv2_femto", 0.9504950495049505, 0.6695076230312109),
    ("deimv2_atto", 1.0, 0.8656765676567655),
];

#[test]
fn the_figures_are_those_of_pycocotools_and_of_counting_by_hand() {
    let out = tempfile::tempdir().unwrap();
    let output = recorded(&skyline(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let summary = read_json(&out.path().join("summary.json"));
    assert_eq!(summary["photos_scored"], 16);
    for (detector, normal, random) in BY_PYCOCOTOOLS {
        let ap = |variant: &str| result(&summary, detector, variant)["overall"]["ap50"].as_f64().unwrap();
        assert!(
            (ap("normal") - normal).abs() < 1e-9 && (ap("random") - random).abs() < 1e-9,
            "{detector}"
        );
        let drop = result(&summary, detector, "random")["drop"]["ap50"].as_f64().unwrap();
        assert!((drop - (normal - random)).abs() < 1e-9);
        assert!(result(&summary, detector, "normal")["drop"].is_null());
    }
    hits_counted_from_the_coco_files(out.path(), &summary);
    let text = stdout(&output);
    assert!(text.contains("yolox_nano      0.871 / 6/8 (75 %)"), "{text}");
}

/// Counts hits and confidences again from the exported COCO files alone, without the program's matching.
fn hits_counted_from_the_coco_files(out: &Path, summary: &Value) {
    let truth = read_json(&out.join("coco_truth.json"));
    let xywh = |v: &Value| -> BoxPx {
        let [x, y, w, h]: [f64; 4] = serde_json::from_value(v.clone()).unwrap();
        BoxPx::new(x, y, x + w, y + h)
    };
    for (detector, ..) in BY_PYCOCOTOOLS {
        let results = read_json(&out.join(format!("coco_results_{detector}.json")));
        for variant in ["normal", "random"] {
            let (mut hits, mut sum) = (0, 0.0);
            for image in truth["images"]
                .as_array()
                .unwrap()
                .iter()
                .filter(|i| i["variant"] == variant)
            {
                let own = |v: &&Value| v["image_id"] == image["id"];
                let model = xywh(&truth["annotations"].as_array().unwrap().iter().find(own).unwrap()["bbox"]);
                let cars = results
                    .as_array()
                    .unwrap()
                    .iter()
                    .filter(own)
                    .filter(|r| r["category_id"] == 3);
                let on_model = cars.filter(|r| xywh(&r["bbox"]).iou(&model) >= 0.5);
                let best = on_model.map(|r| r["score"].as_f64().unwrap()).fold(0.0, f64::max);
                hits += u64::from(best >= 0.5);
                sum += best;
            }
            let overall = &result(summary, detector, variant)["overall"];
            assert_eq!(overall["hit_rate"]["count"], hits, "{detector} {variant}");
            assert!(
                (overall["mean_confidence"].as_f64().unwrap() - sum / 8.0).abs() < 1e-9,
                "{detector} {variant}"
            );
        }
    }
}

#[test]
fn every_azimuth_bin_has_its_photo_of_each_texture() {
    let out = tempfile::tempdir().unwrap();
    assert!(recorded(&skyline(), out.path()).status.success());
    let summary = read_json(&out.path().join("summary.json"));
    for r in summary["results"].as_array().unwrap() {
        let bins = r["azimuth_bins"].as_array().unwrap();
        let azimuths: Vec<f64> = bins.iter().map(|b| b["azimuth_deg"].as_f64().unwrap()).collect();
        assert_eq!(azimuths, [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0]);
        assert!(bins.iter().all(|b| b["figures"]["photos"] == 1));
        let hits: u64 = bins
            .iter()
            .map(|b| b["figures"]["hit_rate"]["count"].as_u64().unwrap())
            .sum();
        assert_eq!(r["overall"]["hit_rate"]["count"], hits);
    }
    assert_eq!(rows(out.path()).len(), 16 * 5);
}

#[test]
fn truth_boxes_hold_the_true_outline_and_not_much_more() {
    let out = tempfile::tempdir().unwrap();
    assert!(recorded(&skyline(), out.path()).status.success());
    let coco = read_json(&out.path().join("coco_truth.json"));
    let exact = read_json(&skyline().join("truth.json"));
    let mut ious = Vec::new();
    for (found, exact) in coco["annotations"]
        .as_array()
        .unwrap()
        .iter()
        .zip(exact["photos"].as_array().unwrap())
    {
        let [x, y, w, h]: [f64; 4] = serde_json::from_value(found["bbox"].clone()).unwrap();
        let exact: BoxPx = serde_json::from_value(exact["box_xyxy_px"].clone()).unwrap();
        let found = BoxPx::new(x, y, x + w, y + h);
        assert!(
            found.x1 < exact.x1 + 2.0 && found.y1 < exact.y1 + 2.0,
            "{found:?} cuts {exact:?}"
        );
        assert!(
            found.x2 > exact.x2 - 2.0 && found.y2 > exact.y2 - 2.0,
            "{found:?} cuts {exact:?}"
        );
        ious.push(found.iou(&exact));
    }
    ious.sort_by(f64::total_cmp);
    println!(
        "IoU of the box envelope with the exact outline: worst {:.3}, median {:.3}",
        ious[0], ious[8]
    );
    assert!(ious[0] > 0.6 && ious[8] > 0.7);
}

#[test]
fn recorded_and_live_runs_are_the_same_numbers() {
    let Some(weights) = shared("detectors") else { return };
    let session = copy_of_skyline();
    let (live, played) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let weights = weights.display().to_string();
    let output = score(session.path(), live.path(), &["--detectors", &weights, "--record"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(recorded(session.path(), played.path()).status.success());
    let (a, b) = (
        read_json(&live.path().join("summary.json")),
        read_json(&played.path().join("summary.json")),
    );
    assert_eq!(a["results"], b["results"]);
    assert_eq!(a["provenance"]["detectors"][0]["source"], "live");
    assert_eq!(b["provenance"]["detectors"][0]["source"], "recorded");
    let same =
        |name: &str| std::fs::read(live.path().join(name)).unwrap() == std::fs::read(played.path().join(name)).unwrap();
    assert!(same("photos.csv") && same("coco_truth.json") && same("coco_results_deimv2_atto.json"));
    // What ships was recorded by this program: nothing has drifted since.
    let shipped = tempfile::tempdir().unwrap();
    assert!(recorded(&skyline(), shipped.path()).status.success());
    let shipped = read_json(&shipped.path().join("summary.json"));
    for (now, then) in a["results"]
        .as_array()
        .unwrap()
        .iter()
        .zip(shipped["results"].as_array().unwrap())
    {
        let figure = |r: &Value, name: &str| r["overall"][name].as_f64().unwrap();
        assert!((figure(now, "ap50") - figure(then, "ap50")).abs() < 0.01, "{now}");
        assert!(
            (figure(now, "mean_confidence") - figure(then, "mean_confidence")).abs() < 0.005,
            "{now}"
        );
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert!(recorded(&skyline(), a.path()).status.success() && recorded(&skyline(), b.path()).status.success());
    for entry in std::fs::read_dir(a.path()).unwrap() {
        let name = entry.unwrap().file_name();
        let bytes = |folder: &Path| std::fs::read(folder.join(&name)).unwrap();
        assert!(bytes(a.path()) == bytes(b.path()), "{name:?} differs");
    }
}

#[test]
fn a_bad_photo_is_reported_and_the_others_still_score() {
    let session = copy_of_skyline();
    let photo = session.path().join("normal_003.jpg");
    let bytes = std::fs::read(&photo).unwrap();
    std::fs::write(&photo, &bytes[..bytes.len() / 3]).unwrap();
    std::fs::remove_file(session.path().join("random_010.jpg")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = recorded(session.path(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let complaints = stderr(&output);
    assert!(complaints.contains("normal_003.jpg ends in the middle") && complaints.contains("random_010.jpg"));
    let summary = read_json(&out.path().join("summary.json"));
    assert_eq!(
        (
            summary["photos_scored"].as_u64(),
            summary["not_scored"].as_array().unwrap().len()
        ),
        (Some(14), 2)
    );
    assert_eq!(result(&summary, "yolox_nano", "normal")["overall"]["photos"], 7);
    let bin_135 = &result(&summary, "yolox_nano", "normal")["azimuth_bins"][3];
    assert!(bin_135["figures"].is_null(), "an empty bin has no figures");
    let html = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(html.contains("Photos not scored") && html.contains("14 photos scored, 2 not scored"));
    assert_eq!(rows(out.path()).len(), 14 * 5 + 2);
}

#[test]
fn a_session_s_own_truth_is_used_instead_of_tags() {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    let exact = read_json(&skyline().join("truth.json"));
    for (entry, exact) in file["photos"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .zip(exact["photos"].as_array().unwrap())
    {
        entry["box_xyxy_px"] = exact["box_xyxy_px"].clone();
        let of = |key: &str| exact[key].clone();
        entry["viewpoint"] = serde_json::json!({
            "azimuth_deg": of("azimuth_deg"), "pitch_deg": of("pitch_deg"), "distance_mm": of("distance_mm")});
    }
    std::fs::write(&path, file.to_string()).unwrap();
    // No tag is needed any more.
    let scene = std::fs::read_to_string(session.path().join("scene.toml")).unwrap();
    std::fs::write(
        session.path().join("scene.toml"),
        &scene[..scene.find("[[tag]]").unwrap()],
    )
    .unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = recorded(session.path(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let coco = read_json(&out.path().join("coco_truth.json"));
    let wanted: BoxPx = serde_json::from_value(exact["photos"][4]["box_xyxy_px"].clone()).unwrap();
    assert_eq!(coco["annotations"][4]["bbox"][0].as_f64(), Some(wanted.x1));
    assert!(
        rows(out.path())
            .iter()
            .all(|r| r.iter().any(|field| field == "session"))
    );
}

#[test]
fn runs_that_cannot_be_are_one_sentence_and_leave_nothing_behind() {
    let parent = tempfile::tempdir().unwrap();
    let out = parent.path().join("report");
    let refused = |output: Output, words: &[&str]| {
        assert_refused(&output, words);
        assert!(!out.exists(), "something was left behind");
    };
    refused(recorded(parent.path(), &out), &["cannot read", "session.json"]);
    refused(
        score(&skyline(), &out, &[]),
        &["no weights for yolox_nano", "detectors fetch"],
    );
    refused(
        score(&skyline(), &out, &["--detector", "yolo99"]),
        &["no detector is called yolo99"],
    );
    refused(
        score(&skyline(), &out, &["--recorded", "--record"]),
        &["--recorded", "--record"],
    );
    let no_session = program()
        .args(["score", "--recorded", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    refused(no_session, &["no session is named"]);
    let twice = program()
        .arg("score")
        .args([skyline(), skyline()])
        .args(["--recorded", "--out"])
        .arg(&out)
        .output();
    refused(twice.unwrap(), &["is named twice"]);

    let session = copy_of_skyline();
    std::fs::remove_file(session.path().join("recorded/fastestdet.json")).unwrap();
    refused(recorded(session.path(), &out), &["cannot read", "fastestdet.json"]);

    // A photo that was exchanged after the recording must not get the old detections.
    let session = copy_of_skyline();
    std::fs::copy(
        session.path().join("random_009.jpg"),
        session.path().join("normal_001.jpg"),
    )
    .unwrap();
    assert!(
        recorded(session.path(), &out).status.success(),
        "the same bytes are the same photo"
    );
    std::fs::remove_dir_all(&out).unwrap();
    let mut bytes = std::fs::read(skyline().join("normal_001.jpg")).unwrap();
    bytes.push(0);
    std::fs::write(session.path().join("normal_001.jpg"), bytes).unwrap();
    refused(
        recorded(session.path(), &out),
        &["normal_001.jpg has no recorded detections", "--record"],
    );

    let session = copy_of_skyline();
    let scene = session.path().join("scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&scene, text.replace("class = \"car\"", "class = \"spaceship\"")).unwrap();
    refused(recorded(session.path(), &out), &["no label `spaceship`"]);
    std::fs::write(&scene, &text[..text.find("[[tag]]").unwrap()]).unwrap();
    refused(
        recorded(session.path(), &out),
        &["none of the 16 photos could be scored", "no tag"],
    );
}

/// Changes the stored session's `session.json` and scores it played back.
fn score_changed(change: impl FnOnce(&mut Vec<Value>)) -> (Output, Value, tempfile::TempDir) {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    change(file["photos"].as_array_mut().unwrap());
    std::fs::write(&path, file.to_string()).unwrap();
    std::fs::copy(session.path().join("normal_001.jpg"), session.path().join("copy.jpg")).unwrap();
    let out = tempfile::tempdir().unwrap();
    let output = recorded(session.path(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    (output, read_json(&out.path().join("summary.json")), out)
}

#[test]
fn what_weakens_the_figures_is_said() {
    let caution = |change: fn(&mut Vec<Value>), words: &str| {
        let (output, summary, out) = score_changed(change);
        let cautions = summary["cautions"].to_string();
        assert!(cautions.contains(words), "{cautions}");
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
        assert!(
            std::fs::read_to_string(out.path().join("report.html"))
                .unwrap()
                .contains(words)
        );
    };
    caution(
        |photos| photos.truncate(10),
        "different numbers of photos in 6 of 8 directions",
    );
    caution(|photos| drop(photos.drain(..8)), "no photo has the variant “normal”");
    caution(|photos| photos[2]["file"] = "copy.jpg".into(), "byte-for-byte copies");
    caution(
        |photos| photos[2]["box_xyxy_px"] = serde_json::json!([5000, 5000, 6000, 6000]),
        "could not be scored",
    );
    let (_, summary, _) = score_changed(|_| {});
    assert_eq!(summary["cautions"].as_array().unwrap().len(), 0);
}

#[test]
fn a_recording_that_was_changed_is_refused() {
    let out = tempfile::tempdir().unwrap();
    for name in ["yolox_nano", "deimv2_atto"] {
        let session = copy_of_skyline();
        let results = session.path().join("recorded").join(format!("{name}.json"));
        std::fs::copy(session.path().join("recorded/nanodet_m.json"), &results).unwrap();
        assert_refused(
            &recorded(session.path(), out.path()),
            &[name, "not the recording", "--record"],
        );
        std::fs::write(&results, "[]").unwrap();
        assert_refused(&recorded(session.path(), out.path()), &[name, "not the recording"]);
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, b"mine").unwrap();
    assert_refused(&recorded(&skyline(), &file), &["cannot write", "is a file"]);
    assert_eq!(std::fs::read(&file).unwrap(), b"mine");
    // One of the files cannot take its place: none does.
    let out = folder.path().join("out");
    std::fs::create_dir_all(out.join("report.html")).unwrap();
    assert_refused(
        &recorded(&skyline(), &out),
        &["cannot write", "report.html", "a folder is in its place"],
    );
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 1);
}

#[test]
fn results_of_an_earlier_run_do_not_stay_beside_new_ones() {
    let out = tempfile::tempdir().unwrap();
    let run = |detector: &str| {
        let output = score(&skyline(), out.path(), &["--recorded", "--detector", detector]);
        assert!(output.status.success(), "{}", stderr(&output));
    };
    run("fastestdet");
    run("yolox_nano");
    assert!(out.path().join("coco_results_yolox_nano.json").exists());
    assert!(!out.path().join("coco_results_fastestdet.json").exists());
}
