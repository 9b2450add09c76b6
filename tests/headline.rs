//! A headline that cannot mislead: intervals beside drops, red only for what is shown, cautions and another base.

use crate::common;

use std::path::Path;
use std::process::Output;

use common::{copy_of_skyline, program, read_json, skyline, stderr, stdout};
use serde_json::Value;

fn score(session: &Path, out: &Path, more: &[&str]) -> Output {
    let mut program = program();
    program.arg("score").arg(session).args(["--recorded", "--out"]).arg(out);
    program.args(more).output().unwrap()
}

fn scored(session: &Path, more: &[&str]) -> (tempfile::TempDir, Value, Output) {
    let out = tempfile::tempdir().unwrap();
    let output = score(session, out.path(), more);
    assert!(output.status.success(), "{}", stderr(&output));
    let summary = read_json(&out.path().join("summary.json"));
    (out, summary, output)
}

/// The stored session with its photos changed.
fn changed(change: impl Fn(&mut Vec<Value>)) -> tempfile::TempDir {
    let session = copy_of_skyline();
    let path = session.path().join("session.json");
    let mut file = read_json(&path);
    change(file["photos"].as_array_mut().unwrap());
    std::fs::write(&path, file.to_string()).unwrap();
    session
}

#[test]
fn a_drop_is_bold_when_it_is_shown_and_not_before() {
    let (out, summary, output) = scored(&skyline(), &[]);
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    let effects: Vec<&str> = summary["paired"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["finding"]["effect"].as_str().unwrap())
        .collect();
    let shown = effects.iter().filter(|effect| **effect == "hides").count();
    assert_eq!((shown, effects.len()), (2, 5), "{effects:?}");
    // Of the first table the word is bold, of the second its confidence and its hits, of the third the matrix; the drops of the others, whose intervals may lie above 0, are not.
    assert_eq!(page.matches("<b>hides</b>").count(), shown);
    assert_eq!(page.matches("<td><b>0.").count(), 2 * shown);
    assert_eq!(page.matches("</b> <small class=\"why\">(hits").count(), shown);
    let text = stdout(&output);
    let row = text.lines().find(|line| line.starts_with("DEIMv2-Femto 416")).unwrap();
    assert!(row.contains(" hides ") && row.contains(" 0.49 [0.30, 0.66] "), "{text}");
    assert!(text.contains("8 pairs from 1 place × 8 bins"), "{text}");
    let tex = std::fs::read_to_string(out.path().join("table.tex")).unwrap();
    assert!(tex.contains("\\textbf{0.75} [0.38, 1.00]"), "{tex}");
}

#[test]
fn ap_and_hit_rate_that_disagree_are_explained_beside_each_other() {
    let (out, summary, output) = scored(&skyline(), &["--all"]);
    // deimv2_atto on random: AP 0.83, one hit of eight, and seven weak finds.
    let wanted =
        "AP@0.5 is 0.83 beside 1 of 8 photos hit, since 7 more photos show the model at a confidence below 0.5";
    let explained = summary["explanations"].as_array().unwrap();
    assert!(
        explained.iter().any(|e| e.as_str().unwrap().contains(wanted)),
        "{explained:?}"
    );
    assert!(stdout(&output).contains(wanted));
    for (file, mark) in [("report.html", "class=\"explained\""), ("table.tex", "% DEIMv2-Atto")] {
        let text = std::fs::read_to_string(out.path().join(file)).unwrap();
        assert!(text.contains(wanted) && text.contains(mark), "{file}");
    }
    // 6 of 8 hits beside AP 0.87 needs no word.
    assert!(!explained.iter().any(|e| e.as_str().unwrap().contains("YOLOX")));
}

#[test]
fn what_a_reviewer_asks_for_first_is_cautioned() {
    let cautions = |session: &Path, more: &[&str]| scored(session, more).1["cautions"].to_string();
    let usual = cautions(&skyline(), &[]);
    assert!(
        usual.contains("all photos are of one place") && usual.contains("looser than its outline"),
        "{usual}"
    );
    for absent in ["share", "random control", "floor effect"] {
        assert!(!usual.contains(absent), "{absent}: {usual}");
    }
    let few = changed(|photos| {
        photos
            .retain(|p| !["random_013.jpg", "random_014.jpg", "random_015.jpg"].contains(&p["file"].as_str().unwrap()))
    });
    assert!(
        cautions(few.path(), &[])
            .contains("“random” and “normal” share 5 cells of place × direction, fewer than the 6")
    );
    let two = changed(|photos| photos[0]["place"] = "garage".into());
    assert!(cautions(two.path(), &[]).contains("the photos are of 2 places"));
    let named = changed(|photos| photos.iter_mut().skip(8).for_each(|p| p["variant"] = "dta".into()));
    assert!(cautions(named.path(), &[]).contains("no variant is a random control"));
    // With the patterned photos as base, most detectors hardly find it.
    let floor = cautions(&skyline(), &["--base", "random"]);
    assert!(
        floor.contains("deimv2_femto finds “random” itself in 0 of 8 photos only") && floor.contains("floor effect"),
        "{floor}"
    );
}

#[test]
fn drops_are_measured_from_the_base_that_is_named() {
    let (out, summary, output) = scored(&skyline(), &["--base", "random"]);
    let (_, usual, _) = scored(&skyline(), &[]);
    let drop = |summary: &Value, variant: &str| {
        let own = |r: &&Value| r["detector"] == "yolox_nano" && r["variant"] == variant;
        summary["results"].as_array().unwrap().iter().find(own).unwrap()["drop"]["hit_rate"].clone()
    };
    assert_eq!(
        drop(&summary, "normal").as_f64(),
        drop(&usual, "random").as_f64().map(|d| -d)
    );
    assert!(drop(&summary, "random").is_null() && summary["base"] == "random");
    assert_eq!(summary["results"][0]["variant"], "random", "the base is listed first");
    assert!(stdout(&output).contains("“normal” "));
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert!(page.contains("drop of the mean confidence from “random”"));
}

#[test]
fn compare_takes_the_confidence_of_a_hit() {
    let out = tempfile::tempdir().unwrap();
    let compared = program()
        .arg("compare")
        .arg(skyline())
        .args(["--recorded", "--confidence", "0.25", "--out"])
        .arg(out.path())
        .output()
        .unwrap();
    assert!(compared.status.success(), "{}", stderr(&compared));
    let page = read_json(&out.path().join("comparison.json"));
    let (_, summary, _) = scored(&skyline(), &["--confidence", "0.25"]);
    assert_eq!(page["provenance"]["hit_confidence"], 0.25);
    assert_eq!(page["results"], summary["paired"]);
    let (_, usual, _) = scored(&skyline(), &[]);
    assert_ne!(page["results"], usual["paired"], "a lower threshold finds more");
    let html = std::fs::read_to_string(out.path().join("comparison.html")).unwrap();
    assert!(html.contains("a hit: confidence ≥ 0.25 and IoU ≥ 0.5"));
}

/// One direction under the names of eight places is one view and not eight.
#[test]
fn copies_under_names_of_other_places_make_no_finding() {
    let direction = |i: usize| {
        changed(|photos| {
            photos.retain(|p| ["normal_001.jpg", "random_009.jpg"].contains(&p["file"].as_str().unwrap()));
            photos.iter_mut().for_each(|p| p["place"] = format!("place {i}").into());
        })
    };
    let sessions: Vec<tempfile::TempDir> = (0..8).map(direction).collect();
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command
        .arg("compare")
        .args(sessions.iter().map(tempfile::TempDir::path));
    command
        .args(["--recorded", "--detector", "deimv2_atto", "--out"])
        .arg(out.path());
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let page = read_json(&out.path().join("comparison.json"));
    let finding = &page["results"][0]["finding"];
    assert_eq!(
        (
            &finding["effect"],
            &finding["withheld_for_copies"],
            &finding["views_missing"]
        ),
        (&"nothing_shown".into(), &true.into(), &5.into()),
        "{finding}"
    );
    let text = stdout(&output);
    assert!(
        text.contains("withheld: what is shown rests on photos that show the same moment again"),
        "{text}"
    );
    assert!(
        stderr(&output).contains("14 photos are byte-for-byte copies of others"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn the_comparison_says_how_many_more_photos_would_tell() {
    let out = tempfile::tempdir().unwrap();
    let mut command = program();
    command
        .arg("compare")
        .arg(skyline())
        .args(["--recorded", "--detector", "yolox_nano", "--out"])
        .arg(out.path());
    assert!(command.output().unwrap().status.success());
    let page = std::fs::read_to_string(out.path().join("comparison.html")).unwrap();
    // The drop that is shown from so many views is that seen at as many more as narrow the interval to it.
    let r = &read_json(&out.path().join("comparison.json"))["results"][0];
    let [from, drop] = [&r["finding"]["drop_shown_from"], &r["mean_confidence"]["drop"]].map(|v| v.as_f64().unwrap());
    let needed = (8.0 * (from / drop).powi(2)).ceil();
    let wanted = format!(
        "if the true drop is the {drop:.2} seen, about {needed} views show it with a chance of 0.8, and these photos are of 8: {} photos more",
        2.0 * (needed - 8.0)
    );
    assert!(page.contains(&wanted), "{wanted}");
    assert!(page.contains("How many more photos would tell"));
}

/// Single photos of a direction are dots: a line would claim a course between them.
#[test]
fn points_of_a_polar_chart_are_joined_where_bins_have_several_photos() {
    let joined = |session: &Path| {
        let (out, ..) = scored(session, &["--detector", "yolox_nano"]);
        let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
        let chart = page
            .split("Mean confidence by azimuth, YOLOX")
            .nth(1)
            .unwrap()
            .split("</svg>")
            .next()
            .unwrap()
            .to_owned();
        chart.contains("<poly")
    };
    assert!(!joined(&skyline()));
    let doubled = copy_of_skyline();
    let path = doubled.path().join("session.json");
    let mut file = read_json(&path);
    let photos = file["photos"].as_array_mut().unwrap();
    for mut photo in photos.clone() {
        let name = photo["file"].as_str().unwrap().to_owned();
        std::fs::copy(doubled.path().join(&name), doubled.path().join(format!("again_{name}"))).unwrap();
        photo["file"] = format!("again_{name}").into();
        // At one place they would be copies, which count once.
        photo["place"] = "elsewhere".into();
        photos.push(photo);
    }
    std::fs::write(&path, file.to_string()).unwrap();
    assert!(joined(doubled.path()));
}

/// Each photo's card says how well it is placed.
#[test]
fn a_photo_shows_the_quality_of_its_pose() {
    let (out, ..) = scored(&skyline(), &["--detector", "yolox_nano"]);
    let page = std::fs::read_to_string(out.path().join("report.html")).unwrap();
    assert_eq!(page.matches("pose: σ ").count(), 16);
    assert!(page.contains(" px</small>"), "rms in pixels");
}
