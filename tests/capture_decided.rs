//! `capture --until-decided`: the capture ends with the pair that decides, asks for telling views, and says what `compare --sequential` says of the same session.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::capture_page::{http, running::Running};
use crate::common;

use common::{assert_refused, program, read_json, skyline, stderr, stdout};
use serde_json::{Value, json};

/// Plain photos in which the detector finds nothing either.
const MISSED: [usize; 2] = [3, 5];

/// A folder with sources, a session and a detector.
struct Desk(tempfile::TempDir);

impl Desk {
    /// Its detector finds the plain model but for two views, by the boxes of a recording, and never the patterned one.
    fn new() -> Desk {
        let desk = Desk(tempfile::tempdir().unwrap());
        let results = read_json(&skyline().join("recorded/deimv2_femto.json"));
        std::fs::create_dir(desk.at("answers")).unwrap();
        for photo in 0..8 {
            let own = results
                .as_array()
                .unwrap()
                .iter()
                .filter(|line| line["image_id"] == photo + 1 && line["category_id"] == 3);
            let best = own
                .max_by(|a, b| a["score"].as_f64().unwrap().total_cmp(&b["score"].as_f64().unwrap()))
                .unwrap();
            let [x, y, w, h] = [0, 1, 2, 3].map(|i| best["bbox"][i].as_f64().unwrap());
            let answer = if MISSED.contains(&(photo as usize)) {
                json!([])
            } else {
                json!([{"label": "car", "score": 1.0, "box": [x, y, x + w, y + h]}])
            };
            std::fs::write(desk.at("answers").join(photo.to_string()), answer.to_string()).unwrap();
        }
        let script = format!(
            "echo '{{\"scaleproof_detector\": 1, \"name\": \"fake\", \"version\": \"1\", \"labels\": \"coco80\", \"input\": \"path\", \"deterministic\": true}}'\n\
             while read -r line; do\nid=${{line#*\\\"id\\\":}}; id=${{id%%[,\\}}]*}}; path=${{line#*\\\"path\\\":\\\"}}; path=${{path%%\\\"*}}\n\
             name=${{path##*/}}; number=${{name##*_}}; number=$(expr ${{number%%.*}} % 8)\n\
             case $name in normal*) found=$(cat '{answers}'/$number);; *) found='[]';; esac\n\
             printf '{{\"id\": %s, \"detections\": %s}}\\n' \"$id\" \"$found\"\ndone\n",
            answers = desk.at("answers").display()
        );
        std::fs::write(desk.at("fake.sh"), script).unwrap();
        desk
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn detector(&self) -> String {
        format!("exec:sh {}", self.at("fake.sh").display())
    }

    /// The stored photos as if they had been taken at another place: other bytes, the same pictures.
    fn source(&self, place: &str) -> String {
        let folder = self.at(place);
        if !folder.exists() {
            std::fs::create_dir(&folder).unwrap();
            for entry in std::fs::read_dir(skyline()).unwrap().map(Result::unwrap) {
                let Ok(mut bytes) = std::fs::read(entry.path()) else {
                    continue;
                };
                if entry.path().extension().is_some_and(|e| e == "jpg") {
                    bytes.extend(place.bytes());
                }
                std::fs::write(folder.join(entry.file_name()), bytes).unwrap();
            }
        }
        format!("replay:{}", folder.display())
    }

    fn capture(&self, variant: &str, place: &str, more: &[&str]) -> Output {
        self.command(variant, place, more).output().unwrap()
    }

    fn command(&self, variant: &str, place: &str, more: &[&str]) -> Command {
        let mut command = program();
        command.args([
            "capture",
            "--source",
            &self.source(place),
            "--variant",
            variant,
            "--place",
            place,
            "--json",
        ]);
        command
            .arg("--scene")
            .arg(skyline().join("scene.toml"))
            .arg("--camera")
            .arg(skyline().join("camera.yaml"));
        command.arg("-o").arg(self.at("session")).args(more);
        command
    }

    /// The patterned model, until it is decided.
    fn until_decided(&self, place: &str, more: &[&str]) -> Output {
        let cache = self.at("cache");
        let usual = [
            "--until-decided",
            "--detector",
            &self.detector(),
            "--cache",
            cache.to_str().unwrap(),
        ];
        self.capture("random", place, &[&usual, more].concat())
    }

    /// Both places' plain photos.
    fn with_plain_photos() -> Desk {
        let desk = Desk::new();
        for place in ["meadow", "garage"] {
            let output = desk.capture("normal", place, &[]);
            assert!(output.status.success(), "{}", stderr(&output));
        }
        // Each place has views of its own.
        assert_eq!(photos(&desk.at("session"), "normal"), 16);
        desk
    }
}

fn lines(output: &Output) -> Vec<Value> {
    stdout(output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn standings(output: &Output) -> Vec<Value> {
    lines(output)
        .into_iter()
        .filter(|line| line.get("pairs").is_some())
        .collect()
}

fn photos(session: &Path, variant: &str) -> usize {
    let session = read_json(&session.join("session.json"));
    session["photos"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|photo| photo["variant"] == variant)
        .count()
}

#[test]
fn it_ends_with_the_pair_that_decides() {
    let desk = Desk::with_plain_photos();
    // Six of eight pairs differ: not yet enough.
    let first = desk.until_decided("meadow", &[]);
    assert!(first.status.success(), "{}", stderr(&first));
    assert_eq!(standings(&first).len(), 9);
    assert!(
        standings(&first).iter().all(|standing| standing["decided"] == false),
        "{}",
        stdout(&first)
    );
    assert!(standings(&first)[0]["pairs"] == "no pair yet" && standings(&first)[8]["next"].is_null());

    // Two more that differ are eight, and the other six views are not needed.
    let second = desk.until_decided("garage", &[]);
    assert!(second.status.success(), "{}", stderr(&second));
    let said = standings(&second);
    assert_eq!(
        said.iter().map(|s| s["decided"] == true).collect::<Vec<_>>(),
        [false, false, true],
        "{}",
        stdout(&second)
    );
    assert!(
        said[2]["pairs"]
            .as_str()
            .unwrap()
            .contains("fake: hides (a drop, shown after 10 of 10 pairs"),
        "{}",
        said[2]
    );
    assert_eq!(
        lines(&second).last().unwrap(),
        &json!({"targets": 8, "filled": 2, "decided": true})
    );
    assert_eq!(photos(&desk.at("session"), "random"), 10);
    // What tells most lies where pairs differed before; nothing was seen in two directions.
    let session = read_json(&skyline().join("session.json"));
    assert_eq!(
        session["photos"][MISSED[0]]["file"], "normal_003.jpg",
        "the case has changed"
    );
    let accepted: Vec<Value> = lines(&desk.capture("normal", "meadow", &[]));
    assert!(accepted.last().unwrap()["open"].as_array().unwrap().is_empty());
    let missed: Vec<f64> = MISSED.iter().map(|i| azimuth_of(&desk, *i)).collect();
    for standing in &said[..2] {
        let next = standing["next"]["azimuth_deg"].as_f64().unwrap();
        assert!(!missed.contains(&next), "{standing} {missed:?}");
    }

    // Asked again it is decided before the first frame, and `compare` says the same of the session.
    let again = desk.until_decided("garage", &[]);
    assert!(
        again.status.success() && standings(&again).len() == 1,
        "{}",
        stdout(&again)
    );
    let out = desk.at("out");
    let compared = program()
        .arg("compare")
        .arg(desk.at("session"))
        .args(["--sequential", "--detector", &desk.detector(), "-o"])
        .arg(&out)
        .arg("--cache")
        .arg(desk.at("cache"))
        .output()
        .unwrap();
    assert!(
        stdout(&compared).contains("a drop, shown after 10 of 10 pairs"),
        "{}{}",
        stdout(&compared),
        stderr(&compared)
    );
}

/// The azimuth bin of a plain photo, from its sidecar.
fn azimuth_of(desk: &Desk, photo: usize) -> f64 {
    let sidecar = read_json(&desk.at("session").join(format!("normal_{photo:03}.capture.json")));
    sidecar["target"]["azimuth_deg"].as_f64().unwrap()
}

#[test]
fn what_cannot_be_decided_is_one_sentence() {
    let desk = Desk::new();
    assert_refused(
        &desk.until_decided("meadow", &[]),
        &["no photos of `normal` at meadow", "capture those first"],
    );
    assert!(!desk.at("session").exists());
    assert!(desk.capture("normal", "meadow", &[]).status.success());
    assert_refused(&desk.until_decided("garage", &[]), &["no photos of `normal` at garage"]);
    assert_refused(&desk.until_decided("meadow", &["--base", "plain"]), &["`plain`"]);
    assert_refused(
        &desk.until_decided("meadow", &["--least", "2"]),
        &["above 0 and below 1"],
    );
    assert_refused(&desk.capture("random", "meadow", &["--until-decided"]), &["--detector"]);
    assert_refused(
        &desk.capture("random", "meadow", &["--detector", "yolox_nano"]),
        &["--until-decided"],
    );
    let own = desk.capture("normal", "meadow", &["--until-decided", "--detector", &desk.detector()]);
    assert_refused(&own, &["`normal`", "held against"]);
    assert_eq!(photos(&desk.at("session"), "random"), 0);
}

/// A program that does not answer alike each time is asked once of each photo: otherwise earlier pairs would be drawn anew at each look, until a drop is shown.
#[test]
fn a_program_is_asked_once_of_each_photo() {
    let desk = Desk::with_plain_photos();
    let (script, asked) = (desk.at("fake.sh"), desk.at("asked"));
    let text = std::fs::read_to_string(&script).unwrap();
    let text = text
        .replace("\"deterministic\": true", "\"deterministic\": false")
        .replace(
            "name=${path##*/};",
            &format!("name=${{path##*/}}; echo $name >> '{}';", asked.display()),
        );
    std::fs::write(&script, text).unwrap();
    let output = desk.until_decided("meadow", &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(standings(&output).len(), 9);
    let asked = std::fs::read_to_string(asked).unwrap();
    let mut names: Vec<&str> = asked.lines().collect();
    names.sort_unstable();
    let all = names.len();
    names.dedup();
    assert_eq!((names.len(), all), (24, 24), "{asked}");
}

/// A capture in a browser until it is decided: the page says what the pairs say and which view tells most, takes no photo that is not needed, and goes on when one is taken back.
#[test]
fn a_page_takes_photos_until_it_is_decided() {
    let desk = Desk::with_plain_photos();
    assert!(desk.until_decided("meadow", &[]).status.success());
    let (detector, cache) = (desk.detector(), desk.at("cache"));
    let page = [
        "--page",
        "--port",
        "0",
        "--until-decided",
        "--detector",
        &detector,
        "--cache",
        cache.to_str().unwrap(),
    ];
    let command = desk.command("random", "garage", &page);
    let mut running = Running::of(command, tempfile::tempdir().unwrap());
    let mut client = running.client();
    let mut wait_for = |wished: &dyn Fn(&Value) -> bool| {
        let mut seen = 0;
        loop {
            let state = client.get(&format!("/state/{seen}")).json();
            seen = state["revision"].as_u64().unwrap();
            // What tells most is what is wanted next.
            if state["pairs"]["is_decided"] == false && state["filled"] == 0 {
                assert!(state["next"].is_number(), "{state}");
            }
            if wished(&state) {
                return state;
            }
        }
    };
    let is_decided = |state: &Value| state["pairs"]["is_decided"] == true;
    let state = wait_for(&is_decided);
    assert_eq!(state["filled"], 2);
    let said = state["pairs"]["sentence"].as_str().unwrap();
    assert!(
        said.contains("fake: hides (a drop, shown after 10 of 10 pairs"),
        "{said}"
    );
    assert!(state["next"].is_null() && state["ended"].is_null());
    let mut hand = running.client();
    let refused = hand.send(&http::post("/shoot"));
    assert_eq!(refused.status, 409);
    assert!(refused.json()["sentence"].as_str().unwrap().contains("press Finish"));
    let photo = std::fs::read(desk.at("garage").join("random_010.jpg")).unwrap();
    assert_eq!(hand.send(&http::upload("image/jpeg", &photo)).status, 409);
    // The source waits, too.
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert_eq!(photos(&desk.at("session"), "random"), 10);

    // Without the last pair it is open again, and the next photo decides it.
    assert_eq!(hand.send(&http::post("/undo")).status, 200);
    let state = wait_for(&is_decided);
    assert_eq!(state["filled"], 2);
    assert_eq!(hand.send(&http::post("/finish")).status, 202);
    let state = wait_for(&|state: &Value| !state["ended"].is_null());
    assert!(
        state["ended"].as_str().unwrap().starts_with("Decided: 2 of 8 views"),
        "{state}"
    );
    let (code, lines) = running.ended();
    assert_eq!(code, Some(0));
    assert_eq!(
        lines.last().unwrap(),
        &json!({"targets": 8, "filled": 2, "decided": true})
    );
    let standings: Vec<&Value> = lines.iter().filter_map(|line| line.get("decided")).collect();
    assert_eq!(
        standings[..5],
        [false, false, true, false, true]
            .map(Value::from)
            .iter()
            .collect::<Vec<_>>()[..]
    );
}
