//! Detectors that are programs: the figures are those of the same detections recorded, what they say of themselves is kept, and whatever a
//! program does wrong ends with one sentence and without a process left behind. The programs are shell scripts.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use common::kills::send;
use common::{HANG, assert_refused, program, read_json, skyline, stderr};
use serde_json::{Value, json};

const HELLO: &str = r#"{"scaleproof_detector": 1, "name": "fake", "version": "fake 1.2", "labels": "coco80", "input": "path", "deterministic": true}"#;

/// Where scripts, answers and reports lie.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Desk {
        Desk {
            folder: tempfile::tempdir().unwrap(),
        }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A script that says its hello and then, for each line, what `answer` prints; it knows `$line`, `$id`, `$path` and `$desk`.
    fn script(&self, hello: &str, answer: &str) -> String {
        let read = r#"id=${line#*\"id\":}; id=${id%%[,\}]*}; path=${line#*\"path\":\"}; path=${path%%\"*}"#;
        let desk = self.folder.path().display();
        self.bare_script(&format!(
            "desk='{desk}'\necho '{hello}'\nwhile read -r line; do {read}; echo \"$id\" >> '{desk}/asked'\n{answer}\ndone\n"
        ))
    }

    fn bare_script(&self, text: &str) -> String {
        let path = self.at("fake.sh");
        std::fs::write(&path, text).unwrap();
        format!("exec:sh {}", path.display())
    }

    /// The recorded detections of yolox_nano, as the answers of a program, one file a photo.
    fn write_answers(&self) {
        std::fs::create_dir(self.at("answers")).unwrap();
        let provenance = read_json(&skyline().join("recorded/yolox_nano.provenance.json"));
        let results = read_json(&skyline().join("recorded/yolox_nano.json"));
        for photo in provenance["photos"].as_array().unwrap() {
            let own = results
                .as_array()
                .unwrap()
                .iter()
                .filter(|line| line["image_id"] == photo["id"]);
            let found: Vec<Value> = own
                .map(|line| {
                    let category = u32::try_from(line["category_id"].as_u64().unwrap()).unwrap();
                    let labels = scaleproof_detect::Labels::Coco80;
                    let label = labels.name(labels.of_category(category).unwrap());
                    let [x, y, w, h] = [0, 1, 2, 3].map(|i| line["bbox"][i].as_f64().unwrap());
                    json!({"label": label, "score": line["score"], "box": [x, y, x + w, y + h]})
                })
                .collect();
            std::fs::write(
                self.at("answers").join(photo["file"].as_str().unwrap()),
                Value::from(found).to_string(),
            )
            .unwrap();
        }
    }

    fn score(&self, detector: &str, out: &str, more: &[&str]) -> Output {
        let (session, cache) = (skyline(), self.at("cache"));
        let mut command = program();
        command
            .arg("score")
            .arg(session)
            .args(["--detector", detector])
            .arg("-o")
            .arg(self.at(out));
        command.arg("--cache").arg(cache).args(more).output().unwrap()
    }

    fn scored(&self, detector: &str, out: &str, more: &[&str]) -> Output {
        let output = self.score(detector, out, more);
        assert!(output.status.success(), "{}", stderr(&output));
        output
    }

    /// How often programs were asked about a photo.
    fn asked(&self) -> usize {
        std::fs::read_to_string(self.at("asked"))
            .unwrap_or_default()
            .lines()
            .count()
    }
}

/// Answers with the stored detections.
const STORED: &str = r#"printf '{"id": %s, "detections": %s}\n' "$id" "$(cat "$desk/answers/${path##*/}")""#;

fn figures(folder: &Path) -> String {
    let summary = read_json(&folder.join("summary.json"));
    [&summary["results"], &summary["reliability"], &summary["cautions"]]
        .map(Value::to_string)
        .concat()
}

#[test]
fn a_program_scores_as_the_same_detections_recorded() {
    let desk = Desk::new();
    desk.write_answers();
    let session = skyline();
    let recorded = desk.at("recorded");
    let arguments = [
        "score",
        session.to_str().unwrap(),
        "--recorded",
        "--detector",
        "yolox_nano",
        "-o",
    ];
    assert!(
        program()
            .args(arguments)
            .arg(&recorded)
            .output()
            .unwrap()
            .status
            .success()
    );
    let hello = HELLO
        .replace("fake\"", "yolox_nano\"")
        .replace("\"input\"", "\"files\": [\"weights.bin\"], \"workers\": 2, \"input\"");
    std::fs::write(desk.at("weights.bin"), "weights").unwrap();
    let line = desk.script(&hello, STORED);
    // A manifest starts it in its own folder, where its weights lie.
    let manifest = desk.at("mine.toml");
    let words: Vec<&str> = line["exec:".len()..].split(' ').collect();
    std::fs::write(
        &manifest,
        format!("command = {words:?}\ntitle = 'Mine'\nlicence = 'MIT'\norigin = 'this test'\n"),
    )
    .unwrap();
    let manifest = manifest.to_str().unwrap();
    desk.scored(manifest, "live", &["--threads", "3"]);
    assert_eq!(figures(&recorded), figures(&desk.at("live")));
    assert_eq!(desk.asked(), 16);

    let detector = &read_json(&desk.at("live/summary.json"))["provenance"]["detectors"][0];
    let hash = |name: &str| scaleproof_core::files::sha256_hex(&std::fs::read(desk.at(name)).unwrap());
    assert_eq!(
        *detector,
        json!({
            "name": "yolox_nano", "title": "Mine", "weights_sha256": null, "version": "fake 1.2", "counted_labels": ["car"],
            "files": {"weights.bin": hash("weights.bin"), "fake.sh": hash("fake.sh")}, "origin": "this test", "licence": "MIT",
            "source": "program", "recorded_by": null,
        })
    );
    // It answers alike each time, so that it is not asked again, until something of it changes.
    desk.scored(manifest, "again", &[]);
    assert_eq!(desk.asked(), 16);
    for shard in ["1/2", "2/2"] {
        desk.scored(manifest, "parts", &["--shard", shard]);
    }
    std::fs::write(desk.at("weights.bin"), "other weights").unwrap();
    let parts = ["1", "2"].map(|n| desk.at("parts").join(format!("shard_{n}_of_2.scaleproof")));
    let merged = program()
        .arg("merge")
        .args(&parts)
        .arg("-o")
        .arg(desk.at("merged"))
        .output()
        .unwrap();
    assert!(merged.status.success(), "{}", stderr(&merged));
    for name in ["summary.json", "report.html"] {
        let read = |folder: &str| std::fs::read(desk.at(folder).join(name)).unwrap();
        assert!(
            read("live") == read("merged") && read("live") == read("again"),
            "{name}"
        );
    }
    desk.scored(manifest, "changed", &[]);
    assert_eq!(desk.asked(), 32);
    assert_eq!(figures(&recorded), figures(&desk.at("changed")));
}

#[test]
fn a_program_that_may_answer_differently_is_asked_each_time_and_that_is_said() {
    let desk = Desk::new();
    desk.write_answers();
    let line = desk.script(&HELLO.replace(", \"deterministic\": true", ""), STORED);
    for times in [1, 2] {
        let output = desk.scored(&line, "out", &[]);
        assert_eq!(desk.asked(), 16 * times);
        assert!(
            stderr(&output).contains("note: fake does not say that it answers alike each time"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn pixels_arrive_as_they_were_decoded() {
    let desk = Desk::new();
    let keep = r#"bytes=${line#*\"bytes\":}; bytes=${bytes%%[,\}]*}; head -c "$bytes" > "$desk/pixels_$id"
        printf '{"id": %s, "detections": [], "width": 1280, "height": 960}\n' "$id""#;
    let line = desk.script(&HELLO.replace("\"path\"", "\"rgb\""), keep);
    desk.scored(&line, "out", &["--threads", "1"]);
    for (id, name) in [(1, "normal_000.jpg"), (16, "random_015.jpg")] {
        let photo = scaleproof::Photo::open(&skyline().join(name)).unwrap();
        let pixels = std::fs::read(desk.at(&format!("pixels_{id}"))).unwrap();
        assert!(pixels == photo.rgb(1).unwrap().into_raw(), "{name}");
    }
}

#[test]
fn a_photo_that_a_program_declines_is_left_out_with_its_sentence() {
    let desk = Desk::new();
    let decline = r#"case $path in *_003.jpg) printf '{"id": %s, "error": "the photo is too green"}\n' "$id";;
        *) printf '{"id": %s, "detections": []}\n' "$id";; esac"#;
    let line = desk.script(HELLO, decline);
    desk.scored(&line, "out", &[]);
    let left_out = &read_json(&desk.at("out/summary.json"))["not_scored"];
    assert_eq!(left_out.as_array().unwrap().len(), 1);
    assert_eq!(left_out[0]["file"], "normal_003.jpg");
    assert_eq!(left_out[0]["reason"], "fake gives no answer: the photo is too green");
}

/// Whether a process runs, by the id that it wrote into a file.
fn runs(file: &Path) -> bool {
    let id = std::fs::read_to_string(file).unwrap();
    let about = std::fs::read_to_string(format!("/proc/{}/stat", id.trim())).unwrap_or_default();
    // What has ended and is not reaped yet is a zombie.
    !about.is_empty() && !about.contains(") Z ")
}

#[test]
fn what_a_program_does_wrong_ends_with_one_sentence_and_with_the_program() {
    let desk = Desk::new();
    let refused = |detector: &str, more: &[&str], words: &[&str]| {
        assert_refused(&desk.score(detector, "out", more), words);
        assert!(!desk.at("out").exists(), "nothing is half-written");
    };
    let found = |what: &str| format!(r#"echo "{{\"id\": $id, \"detections\": [{what}]}}""#);
    let car = r#"{\"label\": \"car\", \"score\": 0.5, \"box\": [1, 2, 30, 40]}"#;
    for (answer, words) in [
        (
            "echo Thinking".to_owned(),
            vec!["the answer of fake about", "begins with \"Thinking\""],
        ),
        (
            r#"echo "{\"id\": 99, \"detections\": []}""#.into(),
            vec!["about photo 99"],
        ),
        (
            found(&car.replace("car", "carr")),
            vec!["the label \"carr\" is none of its 80"],
        ),
        (
            found(&car.replace("0.5", "NaN")),
            vec!["it has NaN where a number belongs"],
        ),
        (found(&car.replace("0.5", "50")), vec!["the confidence 50 is above 1"]),
        (found(&car.replace("30", "2e9")), vec!["reaches far out of the photo"]),
        (found(&vec![car; 10_001].join(", ")), vec!["it has 10001 boxes"]),
        (
            "head -c 20000000 /dev/zero | tr '\\0' x".into(),
            vec!["wrote a line that has no end", "before it answered about"],
        ),
        ("printf '\\377\\n'".into(), vec!["wrote what is no UTF-8 text"]),
        (
            "echo 'Traceback' >&2; echo 'ModuleNotFoundError: no torch' >&2; exit 3".into(),
            vec![
                "ended with exit code 3 before it answered about",
                "its last words: ModuleNotFoundError: no torch",
            ],
        ),
        (
            "kill -9 $$".into(),
            vec!["was ended by signal 9", "before it answered about"],
        ),
        // What it started holds its output open, also outside its group.
        (
            "echo 'out of memory' >&2; sleep 700 & kill -9 $$".into(),
            vec!["was ended by signal 9", "its last words: out of memory"],
        ),
        (
            "setsid sleep 700 & echo $! > \"$desk/child\"; exit 9".into(),
            vec!["ended with exit code 9 before it answered about"],
        ),
        (
            "printf '{\"id\": %d, \"detections\": [{\"label\"' $id; exit 0".into(),
            vec!["ended with exit code 0 before it answered about"],
        ),
        (
            "printf '{\"id\": %d, \"detections\": []}' $id; exit 3".into(),
            vec!["ended with exit code 3 before it answered about"],
        ),
    ] {
        refused(&desk.script(HELLO, &answer), &[], &words);
    }
    assert!(!runs(&desk.at("child")));
    // A program that hangs is stopped, and so is what it has started.
    let hang = "echo $$ > \"$desk/pid\"; setsid sleep 1000 & echo $! > \"$desk/child\"; wait";
    refused(
        &desk.script(HELLO, hang),
        &["--detector-timeout", "1", "--threads", "1"],
        &[
            "has not said anything within 1 s before it answered about normal_000.jpg and was stopped",
            "--detector-timeout",
        ],
    );
    assert!(!runs(&desk.at("pid")) && !runs(&desk.at("child")));

    for (text, words) in [
        (
            "echo 'Loading weights'; sleep 1000",
            vec!["its first line is \"Loading weights\" and not its hello"],
        ),
        (
            "echo '{\"scaleproof_detector\": 1}'; sleep 1000",
            vec!["its hello is not valid: missing field `name`"],
        ),
        (
            "echo 'no such weights' >&2; exit 1",
            vec![
                "ended with exit code 1 before its hello",
                "its last words: no such weights",
            ],
        ),
        (
            "sleep 1000",
            vec!["has not said anything within 1 s before its hello and was stopped"],
        ),
    ] {
        refused(&desk.bare_script(text), &["--detector-timeout", "1"], &words);
    }
    refused(
        "exec:/no/such/program",
        &[],
        &["cannot start `/no/such/program`: no such file"],
    );
    let lost = desk.script(
        &HELLO.replace("\"input\"", "\"files\": [\"/no/weights\"], \"input\""),
        STORED,
    );
    refused(&lost, &[], &["cannot read /no/weights"]);
    // What it is asked does not fit into its pipe, and nobody waits for that.
    let hello = HELLO.replace("\"path\"", "\"rgb\"");
    let blind = r#"id=0; while [ $id -lt 9999 ]; do id=$((id + 1)); echo "{\"id\": $id, \"detections\": []}"; done; sleep 1000"#;
    refused(
        &desk.bare_script(&format!("echo '{hello}'\n{blind}\n")),
        &["--threads", "1"],
        &["cannot be used: it answers without reading its requests"],
    );
    // Started for a second thread, it is another.
    let twice = format!(
        "if mkdir '{0}/first' 2>/dev/null; then name=one; else name=two; fi\n",
        desk.folder.path().display()
    );
    let hello = HELLO
        .replace("\"fake\"", "\"'$name'\"")
        .replace("\"input\"", "\"workers\": 2, \"input\"");
    let text = format!(
        "{twice}echo '{hello}'\nwhile read -r line; do sleep 2; echo '{{\"id\": 1, \"detections\": []}}'; done\n"
    );
    refused(
        &desk.bare_script(&text),
        &["--threads", "2", "--quiet"],
        &["one started another time is another program"],
    );
    refused(
        &desk.script(HELLO, STORED),
        &["--record"],
        &["--record stores the detections of networks, and fake is a program"],
    );
}

#[test]
fn an_interrupted_run_leaves_no_program_behind() {
    let desk = Desk::new();
    let hang = "echo $$ > \"$desk/pid\"; sleep 1000 & echo $! > \"$desk/child\"; wait";
    let line = desk.script(HELLO, hang);
    let mut command = program();
    command
        .arg("score")
        .arg(skyline())
        .args(["--detector", &line, "--threads", "1", "-o"])
        .arg(desk.at("out"));
    let mut running = command.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while !desk.at("child").exists() || std::fs::read_to_string(desk.at("child")).unwrap().is_empty() {
        assert!(start.elapsed() < HANG && running.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(runs(&desk.at("pid")) && runs(&desk.at("child")));
    send(&["-INT"], &running);
    assert_eq!(running.wait().unwrap().code(), Some(130));
    let start = Instant::now();
    while runs(&desk.at("pid")) || runs(&desk.at("child")) {
        assert!(start.elapsed() < HANG, "a program was left behind");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(!desk.at("out").exists());
}

#[test]
fn memory_stays_bounded_over_a_thousand_photos_and_a_chatty_program() {
    let desk = Desk::new();
    let folder = desk.at("session");
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(skyline().join("scene.toml"), folder.join("scene.toml")).unwrap();
    let photos: Vec<Value> = (0..1000)
        .map(|i| {
            let file = format!("{i}.png");
            image::RgbImage::from_pixel(64, 48, image::Rgb([i as u8, (i >> 8) as u8, 7]))
                .save(folder.join(&file))
                .unwrap();
            // Each from a direction of its own: images of one colour in one place are copies of each other.
            let viewpoint = json!({"azimuth_deg": i % 360, "pitch_deg": 10 + 5 * (i / 360), "distance_mm": 850});
            json!({"file": file, "variant": "normal", "box_xyxy_px": [1, 2, 30, 40], "viewpoint": viewpoint})
        })
        .collect();
    std::fs::write(
        folder.join("session.json"),
        json!({"scene": "scene.toml", "photos": photos}).to_string(),
    )
    .unwrap();
    // 200 MB of chatter, and answers of 5,000 boxes.
    let boxes = vec![r#"{"label": 2, "score": 0.9, "box": [1, 2, 30, 40]}"#; 5000].join(", ");
    std::fs::write(desk.at("boxes"), format!("[{boxes}]")).unwrap();
    let chatter = r#"head -c 200000 /dev/zero | tr '\0' x >&2; printf '{"id": %s, "detections": ' "$id"; cat "$desk/boxes"; echo '}'"#;
    let line = desk.script(&HELLO.replace(", \"deterministic\": true", ""), chatter);
    let mut command = program();
    command
        .arg("score")
        .arg(&folder)
        .args(["--detector", &line, "--threads", "2", "-o"])
        .arg(desk.at("out"));
    let mut running = command.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let mut peak_kb = 0;
    while running.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(format!("/proc/{}/status", running.id())).unwrap_or_default();
        let resident = status
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        peak_kb = resident
            .and_then(|kb| kb.trim().parse().ok())
            .unwrap_or(peak_kb)
            .max(peak_kb);
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(running.wait().unwrap().success());
    println!("peak: {} MB", peak_kb / 1024);
    assert_eq!(read_json(&desk.at("out/summary.json"))["photos_scored"], 1000);
    // 136 MB as with one box a photo and with 200 photos, of which the kernel counts 100 as the program's own file; room for all boxes would be 290 MB.
    assert!(peak_kb > 0 && peak_kb < 220 * 1024, "{} MB", peak_kb / 1024);
}
