//! `plan`: the answer in words and numbers, what it rests on, and sealed plans.

use std::path::{Path, PathBuf};

use crate::common;

use common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr, stdout};
use scaleproof_score::{Aim, Endpoint, SealedPlan};
use serde_json::Value;

fn run(arguments: &[&str]) -> std::process::Output {
    program().arg("plan").args(arguments).output().unwrap()
}

fn said(arguments: &[&str]) -> String {
    let output = run(arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

fn numbers(arguments: &[&str]) -> Value {
    serde_json::from_str(&said(&[arguments, &["--json"]].concat())).unwrap()
}

fn number(plan: &Value, key: &str) -> u64 {
    plan[key].as_u64().unwrap()
}

/// Views, places and photos in the first line; what they show, what is assumed and what a place is in one line each.
#[test]
fn the_answer_comes_first() {
    let plan = numbers(&[]);
    assert_eq!((&plan["drop"], &plan["power"]), (&0.2.into(), &0.8.into()));
    assert_eq!(
        (
            number(&plan, "detectors"),
            number(&plan, "textures"),
            number(&plan, "directions")
        ),
        (5, 1, 8)
    );
    let [views, places, photos] = ["views", "places", "photos"].map(|key| number(&plan, key));
    assert_eq!((places, photos), (views.div_ceil(8), places * 16));
    // Three rounds of each texture: a day is enough.
    assert!(photos <= 48, "{plan}");
    assert!(plan["chance_with_a_place_less"].as_f64().unwrap() < 0.8, "{plan}");
    assert!(
        plan["chance"].as_f64().unwrap() >= 0.8 && plan["chance_error"].as_f64().unwrap() < 0.02,
        "{plan}"
    );
    let text = said(&[]);
    let lines: Vec<&str> = text.lines().collect();
    let answer =
        format!("{views} views: e.g. {places} places × 8 directions, {photos} photos with plain and one texture.");
    assert_eq!((lines.len(), lines[0]), (4, answer.as_str()), "{text}");
    for (line, words) in [
        (
            1,
            [
                "mean confidence by 0.2 of one of 5 detectors",
                "2000 simulated experiments, seed",
            ],
        ),
        (2, ["by 0.21 (standard deviation)", "the stored session and films"]),
        (
            3,
            [
                "A place is one spot and light",
                "for places like these it takes 6 places or more",
            ],
        ),
    ] {
        assert!(words.iter().all(|words| lines[line].contains(words)), "{text}");
    }
}

/// Detectors, textures, a scene's views and looks after each view go together, and each asks for more.
#[test]
fn comparisons_and_looks_are_planned_together() {
    let scene = skyline().join("scene.toml");
    let (one, more) = (numbers(&["--drop", "0.3"]), ["--drop", "0.3", "--comparisons", "6x2"]);
    let two = numbers(&more);
    assert!(number(&two, "views") > number(&one, "views"), "{one} {two}");
    assert_eq!(number(&two, "photos"), number(&two, "places") * 8 * 3);
    assert_eq!(number(&two, "fewest_places_like_these"), 7);
    let looks = [
        &more[..],
        &["--sequential", "--least", "0.2", "--scene", scene.to_str().unwrap()],
    ]
    .concat();
    let plan = numbers(&looks);
    assert_eq!((&plan["views"], number(&plan, "directions")), (&two["views"], 8));
    let most = number(&plan["sequential"], "most_views");
    assert!(
        most > number(&plan, "views") && number(&plan, "places") == most.div_ceil(8),
        "{plan}"
    );
    let rows = plan["sequential"]["table"].as_array().unwrap();
    let share = |row: &Value, key: &str| row[key].as_f64().unwrap();
    assert!(
        share(&rows[0], "real_drop") == 0.0 && share(&rows[0], "drop_shown") < 0.05,
        "{plan}"
    );
    let text = said(&looks);
    assert!(
        text.starts_with(&format!("{most} views at most, looked at after each: e.g. "))
            && text.contains(&format!("looked at once, {} views do it", two["views"]))
            && text.contains("6 detectors")
            && text.contains("below 0.2"),
        "{text}"
    );
}

/// A copy of the stored session with these photos alone.
fn session_of(variants: &[&str]) -> tempfile::TempDir {
    let folder = copy_of_skyline();
    let path = folder.path().join("session.json");
    let mut file = read_json(&path);
    let photos = file["photos"].as_array_mut().unwrap();
    photos.retain(|photo| variants.contains(&photo["variant"].as_str().unwrap()));
    std::fs::write(&path, file.to_string()).unwrap();
    folder
}

#[test]
fn a_session_tells_how_confidences_vary() {
    let stored = skyline().display().to_string();
    let both = numbers(&[&stored]);
    assert_eq!((number(&both, "detectors"), number(&both, "textures")), (5, 1));
    assert_eq!(both["spread"]["from"], "paired_photos");
    assert!(said(&[&stored]).contains("as they do in 8 views"));
    let plain = session_of(&["normal"]);
    let plain = plain.path().to_str().unwrap();
    let text = said(&[plain]);
    assert!(
        text.contains("by 0.20 (standard deviation)") && text.contains("as the plain confidence does in 8 views"),
        "{text}"
    );
    assert_eq!(numbers(&[plain])["spread"]["from"], "plain_photos");
    // No detector's mean confidence is above 0.82.
    assert_refused(
        &run(&[plain, "--drop", "0.9"]),
        &["above 0.82", "mean confidence", "0.9"],
    );
    std::fs::remove_dir_all(Path::new(plain).join("recorded")).unwrap();
    assert_refused(&run(&[plain]), &["has no recordings", "--record"]);
}

#[test]
fn what_cannot_be_planned_is_one_sentence() {
    for (arguments, words) in [
        (&["--drop", "0"][..], &["drop", "above 0"][..]),
        (&["--drop", "1.5"], &["drop", "1.5"]),
        (&["--drop", "0.001"], &["too small"]),
        (&["--drop", "0.001", "--sequential"], &["too small"]),
        (&["--power", "0.2"], &["power", "0.2"]),
        (&["--comparisons", "5x0"], &["as in 5x2"]),
        (&["--comparisons", "five"], &["as in 5x2"]),
        (
            &["--sequential", "--least", "0.5"],
            &["0.5", "must not be above the drop"],
        ),
        (&["--least", "0.1"], &["--sequential"]),
        (&["--places", "3"], &["--seal"]),
        (&["nowhere"], &["nowhere"]),
    ] {
        assert_refused(&run(arguments), words);
    }
}

fn sealed(folder: &Path, name: &str, more: &[&str]) -> (PathBuf, String) {
    let (plan, scene) = (folder.join(name), skyline().join("scene.toml"));
    let usual = ["--seal", plan.to_str().unwrap(), "--scene", scene.to_str().unwrap()];
    let named = ["--texture", "normal", "random", "--detector", "yolox_nano,deimv2_femto"];
    let text = said(&[&usual[..], &named, more].concat());
    (plan, text)
}

/// Drop, power, what decides and when it stops stand in the plan together; a plan that cannot show its drop says what would.
#[test]
fn a_sealed_plan_states_what_it_is_to_show() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, text) = sealed(folder.path(), "fixed.json", &["--drop", "0.2"]);
    let aim = read_json(&plan)["plan"]["aim"].clone();
    assert_eq!(
        (
            &aim["primary_endpoint"],
            &aim["drop"],
            &aim["power"],
            &aim["comparisons"]
        ),
        (&"mean_confidence".into(), &0.2.into(), &0.8.into(), &2.into())
    );
    let needed = number(&aim, "places_needed");
    assert_eq!(aim["places_needed"], numbers(&["--comparisons", "2x1"])["places"]);
    assert!(
        needed > 1 && text.contains("primary endpoint: mean confidence"),
        "{text}"
    );
    assert!(text.contains(&format!("--places {needed}")), "{text}");
    let enough = ["--drop", "0.2", "--places", &needed.to_string()];
    let (plan, text) = sealed(folder.path(), "enough.json", &enough);
    assert!(
        read_json(&plan)["plan"]["places"] == needed && !text.contains("too few"),
        "{text}"
    );
    let stops = ["--drop", "0.4", "--sequential", "--least", "0.2"];
    let (plan, text) = sealed(folder.path(), "stops.json", &stops);
    let stopping = &read_json(&plan)["plan"]["stopping"];
    assert!(
        stopping["decided"]["least"] == 0.2 && text.contains("until it is decided"),
        "{text}"
    );
}

/// The confidence decides where the plan says so, and McNemar's test of the hit rate where it was sealed for that: with 8 pairs, of which 6 lose their hit, p = 2/64 · 2.
#[test]
fn a_plan_is_judged_by_what_it_was_sealed_for() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, _) = sealed(folder.path(), "new.json", &["--drop", "0.5"]);
    let (file, _) = SealedPlan::read(&plan).unwrap();
    let aim = Aim {
        primary_endpoint: Endpoint::HitRate,
        base_rate: Some(0.9),
        spread: None,
        ..file.aim.unwrap()
    };
    let old = folder.path().join("old.json");
    SealedPlan { aim: Some(aim), ..file }.write(&old).unwrap();
    let effect = |plan: &Path| {
        let out = tempfile::tempdir().unwrap();
        let mut compare = program();
        compare
            .arg("compare")
            .arg(skyline())
            .args(["--recorded", "--detector", "yolox_nano,deimv2_femto"]);
        compare.arg("--plan").arg(plan).arg("-o").arg(out.path());
        let output = compare.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let page = read_json(&out.path().join("comparison.json"));
        assert_eq!(page["plan"]["deviations"], serde_json::json!([]));
        let results = page["results"].as_array().unwrap();
        let femto = results.iter().find(|r| r["detector"] == "deimv2_femto").unwrap();
        (
            femto["finding"]["effect"].clone(),
            page["plan"]["judged_by_hit_rate"].clone(),
        )
    };
    assert_eq!(effect(&plan), ("hides".into(), false.into()));
    assert_eq!(effect(&old), ("nothing_shown".into(), true.into()));
}
