//! Detections from outside: what the five detectors found, read back as another program's files, gives the same figures; what such files leave
//! open is refused or said; and sessions are exported for other programs.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, read_json, run, skyline, stderr, stdout, text};
use serde_json::{Value, json};

const DETECTORS: [&str; 5] = ["yolox_nano", "nanodet_m", "fastestdet", "deimv2_femto", "deimv2_atto"];

fn done(arguments: &[&str]) -> Output {
    let output = run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    output
}

/// A folder with the report of the recorded detections.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Desk {
        let desk = Desk {
            folder: tempfile::tempdir().unwrap(),
        };
        done(&["score", text(&skyline()), "--recorded", "-o", text(&desk.at("report"))]);
        desk
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The report's COCO results of a detector, with names in place of numbers.
    fn by_name(&self, detector: &str, name_of: impl Fn(&str) -> String) -> Value {
        let images = read_json(&self.at("report/coco_truth.json"));
        let name = |id: &Value| {
            let images = images["images"].as_array().unwrap();
            name_of(
                images.iter().find(|image| image["id"] == *id).unwrap()["file_name"]
                    .as_str()
                    .unwrap(),
            )
        };
        let mut results = read_json(&self.at(&format!("report/coco_results_{detector}.json")));
        for line in results.as_array_mut().unwrap() {
            line["image_id"] = name(&line["image_id"]).into();
        }
        results
    }

    /// Writes the results as YOLO's text files, with all digits that a number has.
    fn write_yolo(&self, detector: &str) {
        let folder = self.at(&format!("yolo/{detector}/labels"));
        std::fs::create_dir_all(&folder).unwrap();
        let mut files = std::collections::BTreeMap::<String, String>::new();
        for line in self
            .by_name(detector, |name| name.replace(".jpg", ".txt"))
            .as_array()
            .unwrap()
        {
            let numbers: Vec<f64> = line["bbox"]
                .as_array()
                .unwrap()
                .iter()
                .map(|v| v.as_f64().unwrap())
                .collect();
            let [x, y, w, h] = numbers[..] else { panic!("{line}") };
            let shares = [(x + w / 2.0) / 1280.0, (y + h / 2.0) / 960.0, w / 1280.0, h / 960.0];
            let class = coco_class(line["category_id"].as_u64().unwrap());
            let shares = shares.map(|share| share.to_string()).join(" ");
            let file = files.entry(line["image_id"].as_str().unwrap().to_owned()).or_default();
            file.push_str(&format!("{class} {shares} {}\n", line["score"]));
        }
        for (name, content) in files {
            std::fs::write(folder.join(name), content).unwrap();
        }
    }

    fn write(&self, name: &str, value: &Value) -> PathBuf {
        let path = self.at(name);
        std::fs::write(&path, value.to_string()).unwrap();
        path
    }
}

/// COCO's 80 classes are numbered by their category ids, which lack eleven numbers.
fn coco_class(category: u64) -> u64 {
    let gaps = [12, 26, 29, 30, 45, 66, 68, 69, 71, 83];
    category - 1 - gaps.iter().filter(|gap| **gap < category).count() as u64
}

/// All but where the detections came from, and so by whose rule labels count.
fn figures(folder: &Path) -> String {
    let mut summary = read_json(&folder.join("summary.json"));
    summary["provenance"]["detectors"] = Value::Null;
    summary["box_labels"] = Value::Null;
    // They begin with the detector's title, which files of results do not have.
    for sentence in summary["explanations"].as_array_mut().unwrap() {
        let (_, told) = sentence.as_str().unwrap().split_once(" on “").unwrap();
        *sentence = told.into();
    }
    summary["paper"] = Value::Null;
    untitled(&mut summary["effects"]);
    serde_json::to_string_pretty(&summary).unwrap()
}

/// Rows of a table without the detector's title.
fn untitled(table: &mut Value) {
    for row in table.as_array_mut().unwrap() {
        row["detector"] = Value::Null;
    }
}

fn assert_same(a: &Path, b: &Path) {
    assert_eq!(figures(a), figures(b));
    let files = ["photos.csv", "figures.csv", "coco_truth.json"].map(str::to_owned);
    for name in files
        .into_iter()
        .chain(DETECTORS.map(|d| format!("coco_results_{d}.json")))
    {
        let read = |folder: &Path| {
            let text = std::fs::read_to_string(folder.join(&name)).unwrap();
            let rules = ["best", "all", "listed"].iter();
            rules.fold(text, |text, rule| {
                text.replace(&format!("coco-101,{rule},"), "coco-101,given,")
            })
        };
        assert!(read(a) == read(b), "{name}");
    }
}

/// `--results NAME=FILE` for every detector.
fn for_all(file: impl Fn(&str) -> PathBuf) -> Vec<String> {
    let given = DETECTORS.map(|d| ["--results".to_owned(), format!("{d}={}", file(d).display())]);
    given.concat()
}

fn score_with<'a>(desk: &Desk, out: &str, given: &'a [String], more: &[&'a str]) -> PathBuf {
    let (session, folder) = (skyline(), desk.at(out));
    let mut arguments = vec!["score", text(&session), "-o", text(&folder)];
    arguments.extend(given.iter().map(String::as_str).chain(more.iter().copied()));
    done(&arguments);
    folder
}

#[test]
fn the_detectors_own_results_come_back_as_the_same_summary() {
    let desk = Desk::new();
    let report = desk.at("report");
    let by_number = for_all(|d| report.join(format!("coco_results_{d}.json")));
    let images = report.join("coco_truth.json");
    let numbered = score_with(&desk, "numbered", &by_number, &["--images", text(&images)]);
    assert_same(&report, &numbered);

    let by_name = for_all(|d| {
        desk.write(
            &format!("{d}.json"),
            &desk.by_name(d, |name| format!("/data/val/{name}")),
        )
    });
    assert_same(&report, &score_with(&desk, "named", &by_name, &[]));
    // As Ultralytics calls them.
    let by_stem = for_all(|d| desk.write(&format!("{d}.json"), &desk.by_name(d, |name| name.replace(".jpg", ""))));
    assert_same(&report, &score_with(&desk, "stems", &by_stem, &[]));

    DETECTORS.iter().for_each(|d| desk.write_yolo(d));
    let yolo = for_all(|d| desk.at(&format!("yolo/{d}")));
    assert_same(&report, &score_with(&desk, "yolo_report", &yolo, &[]));

    // Where they came from is said.
    let summary = read_json(&numbered.join("summary.json"));
    let detector = &summary["provenance"]["detectors"][0];
    let hash = |path: &Path| scaleproof_core::files::sha256_hex(&std::fs::read(path).unwrap());
    assert_eq!(detector["source"], "results");
    assert_eq!(detector["weights_sha256"], Value::Null);
    let results = report.join("coco_results_yolox_nano.json");
    assert_eq!(
        detector["files"],
        json!({"coco_results_yolox_nano.json": hash(&results), "coco_truth.json": hash(&images)})
    );
    let page = std::fs::read_to_string(numbered.join("report.html")).unwrap();
    assert!(page.contains("Detections from outside") && page.contains(&hash(&results)));
}

#[test]
fn results_from_outside_go_through_shards_and_comparisons_and_beside_other_detectors() {
    let desk = Desk::new();
    let (session, report) = (skyline(), desk.at("report"));
    let images = report.join("coco_truth.json");
    let given: Vec<String> = for_all(|d| report.join(format!("coco_results_{d}.json")));
    // Two from outside, and one that is recorded, in this order: those that are named come first.
    let two = &given[..4];
    let more = ["--recorded", "--detector", "fastestdet", "--images", text(&images)];
    let whole = score_with(&desk, "whole", two, &more);
    let parts = desk.at("parts");
    for shard in ["1/2", "2/2"] {
        score_with(&desk, "parts", two, &[&more[..], &["--shard", shard]].concat());
    }
    // The files of the other program are not needed any more.
    std::fs::rename(&images, desk.at("elsewhere.json")).unwrap();
    let [one, two] = ["1", "2"].map(|n| parts.join(format!("shard_{n}_of_2.scaleproof")));
    let merged = desk.at("merged");
    done(&["merge", text(&one), text(&two), "-o", text(&merged)]);
    for name in ["summary.json", "report.html", "photos.csv", "table.tex"] {
        assert!(
            std::fs::read(whole.join(name)).unwrap() == std::fs::read(merged.join(name)).unwrap(),
            "{name}"
        );
    }
    let summary = read_json(&merged.join("summary.json"));
    let names = summary["provenance"]["detectors"].as_array().unwrap().iter();
    let names: Vec<&str> = names.map(|d| d["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["fastestdet", "yolox_nano", "nanodet_m"]);
    std::fs::rename(desk.at("elsewhere.json"), &images).unwrap();

    let compared = |out: &str, more: &[&str]| {
        let folder = desk.at(out);
        done(&[&["compare", text(&session), "-o", text(&folder)], more].concat());
        let mut page = read_json(&folder.join("comparison.json"));
        page["provenance"]["detectors"] = Value::Null;
        page["paper"] = Value::Null;
        untitled(&mut page["effects"]);
        (page["box_labels"].take(), page)
    };
    let strings: Vec<&str> = given
        .iter()
        .map(String::as_str)
        .chain(["--images", text(&images)])
        .collect();
    let ((_, recorded), (rules, outside)) = (compared("recorded", &["--recorded"]), compared("outside", &strings));
    assert_eq!(recorded, outside);
    assert!(
        rules.as_object().unwrap().values().all(|rule| rule == "given"),
        "{rules}"
    );
}

/// Changes a line of results; false removes it.
type Change<'a> = &'a dyn Fn(&mut Value) -> bool;

/// What makes a model look as if it were never found, and is not the pattern: photos that were not looked at, boxes of another scale, classes of
/// another numbering.
#[test]
fn results_that_cannot_be_of_these_photos_are_said() {
    let desk = Desk::new();
    let images = desk.at("report/coco_truth.json");
    let own = read_json(&desk.at("report/coco_results_yolox_nano.json"));
    let with = |change: Change| {
        let mut lines = own.as_array().unwrap().clone();
        lines.retain_mut(change);
        desk.write("yolox_nano.json", &Value::Array(lines))
    };
    let said = |file: &Path| {
        let (given, session) = (format!("yolox_nano={}", file.display()), skyline());
        let out = desk.at("said");
        let output = done(&[
            "score",
            text(&session),
            "--results",
            &given,
            "--images",
            text(&images),
            "-o",
            text(&out),
        ]);
        let cautions = read_json(&out.join("summary.json"))["cautions"].to_string();
        (stderr(&output), cautions)
    };
    let cases: [(Change, &str); 3] = [
        (
            &|line| line["image_id"].as_u64().unwrap() <= 8,
            "the results of yolox_nano have no detection in 8 of 16 photos (the first: random_008.jpg)",
        ),
        (
            &|line| {
                for number in line["bbox"].as_array_mut().unwrap() {
                    *number = (number.as_f64().unwrap() / 2.0).into();
                }
                true
            },
            "no box of yolox_nano overlaps a truth box by 0.5 in any of 16 photos",
        ),
        (
            &|line| {
                line["category_id"] = 1.into();
                true
            },
            "yolox_nano gives no detection the label of the model, and most often “person”",
        ),
    ];
    for (change, sentence) in cases {
        let (terminal, cautions) = said(&with(change));
        assert!(
            terminal.contains(sentence) && cautions.contains(sentence),
            "{sentence}: {terminal}"
        );
    }
    let (terminal, _) = said(&with(&|_| true));
    assert!(
        !terminal.contains("yolox_nano has") && !terminal.contains("no detection"),
        "{terminal}"
    );
}

/// The names of a YOLO data set's own description, listed or by number.
#[test]
fn categories_are_read_from_a_yolo_data_set() {
    let desk = Desk::new();
    desk.write_yolo("yolox_nano");
    let results = desk.at("yolo/yolox_nano");
    let score = |yaml: &str| {
        std::fs::write(desk.at("data.yaml"), yaml).unwrap();
        let (given, session) = (format!("yolox_nano={}", results.display()), skyline());
        let (data, out) = (desk.at("data.yaml"), desk.at("out"));
        run(&[
            "score",
            text(&session),
            "--results",
            &given,
            "--categories",
            text(&data),
            "-o",
            text(&out),
        ])
    };
    let names: Vec<String> = (0..80)
        .map(|n| if n == 2 { "car".into() } else { format!("c{n}") })
        .collect();
    let numbered: String = names
        .iter()
        .enumerate()
        .map(|(n, name)| format!("  {n}: {name}\n"))
        .collect();
    for yaml in [
        format!("path: .\nnames: [{}]\n", names.join(", ")),
        format!("path: .\nnames:\n{numbered}"),
    ] {
        let output = score(&yaml);
        assert!(output.status.success(), "{}", stderr(&output));
        let ap =
            |folder: &str| read_json(&desk.at(folder).join("summary.json"))["results"][0]["overall"]["ap50"].clone();
        assert_eq!(ap("out"), ap("report"));
    }
    assert_refused(
        &score("path: .\n"),
        &["data.yaml: it has no `names`, neither a list nor by number"],
    );
    assert_refused(
        &score("names: {0: car, 2: truck}\n"),
        &["data.yaml: its `names` have no number 1"],
    );
}

/// A detection of the first photo.
fn line(bbox: [f64; 4], score: f64) -> Value {
    json!({"image_id": "normal_000", "category_id": 3, "bbox": bbox, "score": score})
}

#[test]
fn what_results_leave_open_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let good = line([474.0, 331.0, 306.0, 315.0], 0.9);
    let changed = |key: &str, value: Value| {
        let mut line = good.clone();
        line[key] = value;
        json!([good, line])
    };
    let mut without_score = good.clone();
    without_score.as_object_mut().unwrap().remove("score");
    let refused = |results: &str, more: &[&str], words: &[&str]| {
        std::fs::write(at("results.json"), results).unwrap();
        let (session, given, out) = (skyline(), format!("mine={}", at("results.json").display()), at("out"));
        let usual = ["score", text(&session), "--results", &given, "-o", text(&out)];
        assert_refused(&run(&[&usual, more].concat()), words);
        assert!(!out.exists(), "nothing is half-written");
    };
    for (results, words) in [
        (
            changed("image_id", json!(7)),
            vec!["names its images by number (7)", "--images"],
        ),
        (
            changed("category_id", json!(12)),
            vec!["the category 12 is none of COCO's", "--categories"],
        ),
        (
            changed("score", json!(87.5)),
            vec!["normal_000.jpg", "87.5 is above 1", "divide it by 100"],
        ),
        (changed("score", json!(-0.5)), vec!["-0.5 is none"]),
        (
            json!([good, without_score]),
            vec!["detection 2 (of normal_000)", "has no score"],
        ),
        (
            json!([good, good]),
            vec!["normal_000.jpg: a detection is there twice", "remove the copy"],
        ),
        (
            changed("bbox", json!([1400, 10, 90, 90])),
            vec!["normal_000.jpg", "lies outside the photo of 1280×960 px"],
        ),
        // Corners where width and height belong.
        (
            changed("bbox", json!([600, 400, 900, 800])),
            vec!["reaches far out of the photo of 1280×960 px", "x1, y1, x2, y2"],
        ),
        (
            changed("bbox", json!([600, 400, -9, 80])),
            vec!["detection 2", "bbox is [600.0, 400.0, -9.0, 80.0]"],
        ),
        (
            json!([line([0.4, 0.3, 0.2, 0.2], 0.9)]),
            vec!["look like shares of the photo"],
        ),
        (
            json!({"annotations": []}),
            vec!["it is an object", "name the results and not the annotations"],
        ),
        (json!([]), vec!["no detection in any photo"]),
        (
            json!([{"image_id": "tree.jpg", "category_id": 3, "bbox": [1, 2, 30, 40], "score": 0.5}]),
            vec!["no detection in any photo", "it has tree.jpg"],
        ),
        (
            changed("image_id", json!("b/normal_000.jpg")),
            vec![
                "detection 2 (of b/normal_000.jpg): normal_000 and b/normal_000.jpg may both be the photo normal_000.jpg",
            ],
        ),
        (json!([3]), vec!["results.json, line 1"]),
    ] {
        refused(&results.to_string(), &[], &words);
    }
    refused(
        "[{\"image_id\": \"normal_000\",\n\"score\": NaN}]",
        &[],
        &["results.json, line 2"],
    );

    let images = |change: &dyn Fn(&mut Value)| {
        let session = read_json(&skyline().join("session.json"));
        let photos = session["photos"].as_array().unwrap().iter().zip(1..);
        let images: Vec<Value> = photos
            .map(|(photo, id)| json!({"id": id, "file_name": photo["file"], "width": 1280, "height": 960}))
            .collect();
        let mut page = json!({"images": images, "annotations": [], "categories": [{"id": 3, "name": "car"}]});
        change(&mut page);
        std::fs::write(at("images.json"), page.to_string()).unwrap();
        at("images.json")
    };
    let numbered = json!([{"image_id": 1, "category_id": 3, "bbox": [474, 331, 306, 315], "score": 0.9}]).to_string();
    type Change = fn(&mut Value);
    for (change, words) in [
        (
            (|page| drop(page["images"].as_array_mut().unwrap().pop())) as Change,
            vec!["does not list the photo random_015.jpg"],
        ),
        (
            |page| page["images"][0]["id"] = 99.into(),
            vec!["detection 1 (of image 1)", "none of this id"],
        ),
        (
            |page| page["images"][1]["id"] = 1.into(),
            vec!["the id of image 1 appears twice"],
        ),
        (
            |page| page["images"][1]["file_name"] = "b/normal_000.jpg".into(),
            vec!["may both be the photo normal_000.jpg"],
        ),
        (
            |page| page["categories"][0]["id"] = 1.into(),
            vec!["calls the category 1 `car`, and in COCO it is `person`", "--categories"],
        ),
        (
            |page| (page["images"][0]["width"], page["images"][0]["height"]) = (960.into(), 1280.into()),
            vec![
                "results.json, normal_000.jpg",
                "an image of 960×1280 px",
                "did not turn it as its EXIF says",
            ],
        ),
    ] {
        let images = images(&change);
        refused(&numbered, &["--images", text(&images)], &words);
    }
    std::fs::write(at("names.txt"), "tree\n\ncar\n").unwrap();
    refused(
        &json!([good]).to_string(),
        &["--categories", text(&at("names.txt"))],
        &["names.txt", "line 2 is empty"],
    );
    std::fs::write(at("names.txt"), "tree\nhouse\n").unwrap();
    let mut first = good.clone();
    first["category_id"] = 1.into();
    let names = at("names.txt");
    refused(
        &json!([first]).to_string(),
        &["--categories", text(&names)],
        &["mine has no label `car`"],
    );
    refused(
        &json!([good]).to_string(),
        &["--categories", text(&names)],
        &["the category 3 is none of", "names.txt's"],
    );
}

#[test]
fn what_text_files_leave_open_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let labels = folder.path().join("labels");
    std::fs::create_dir(&labels).unwrap();
    let (session, out) = (skyline(), folder.path().join("out"));
    let given = format!("mine={}", labels.display());
    let arguments = ["score", text(&session), "--results", &given, "-o", text(&out)];
    assert_refused(&run(&arguments), &["labels", "it has no text files"]);
    std::fs::write(labels.join("tree.txt"), "2 0.5 0.5 0.2 0.2 0.9\n").unwrap();
    assert_refused(
        &run(&arguments),
        &["none of its text files is called as a photo", "tree.txt"],
    );
    for (content, words) in [
        ("2 0.5 0.5 0.2 0.2", ["normal_000.txt, line 1", "it has no confidence"]),
        ("2 0.5 0.5 0.2 0.2 0.9 7", ["line 1", "and nothing else"]),
        ("2 0.5 0.5 0.2 x 0.9", ["line 1", "give class, centre x"]),
        ("\n2 640 480 100 100 0.9", ["line 2", "not pixels"]),
        (
            "80 0.5 0.5 0.2 0.2 0.9",
            ["line 1", "the class 80 is none of the 80 labels"],
        ),
        ("car 0.5 0.5 0.2 0.2 0.9", ["line 1", "\"car\" is no whole number"]),
        ("2 0.5 0.5 0.2 0.2 90", ["normal_000.jpg", "90 is above 1"]),
        ("2 0.5 0.5 nan 0.2 0.9", ["line 1", "has no size"]),
        ("2 0.5 0.5 0.2 0.2 nan", ["normal_000.jpg", "NaN is none"]),
        ("2 1.3 0.5 0.2 0.2 0.9", ["normal_000.jpg", "lies outside the photo"]),
    ] {
        std::fs::write(labels.join("normal_000.txt"), content).unwrap();
        assert_refused(&run(&arguments), &words);
    }
    std::fs::write(labels.join("normal_000.txt"), "2 0.5 0.5 0.2 0.2 0.9\n").unwrap();
    std::fs::create_dir(labels.join("more")).unwrap();
    std::fs::write(labels.join("more/normal_000.txt"), "").unwrap();
    assert_refused(
        &run(&arguments),
        &[
            "labels/more/normal_000.txt".trim_start_matches("labels/"),
            "may both be of the photo normal_000.jpg",
        ],
    );
}

#[test]
fn what_weakens_the_figures_of_results_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.json");
    let mut lines = vec![
        line([474.0, 331.0, 306.0, 315.0], 0.9),
        line([1200.0, 331.0, 100.0, 315.0], 0.4),
    ];
    lines.extend((0..101).map(|i| line([f64::from(i), 1.0, 20.0, 20.0], 0.3)));
    lines.push(line([5.0, 5.0, 0.0, 7.0], 0.3));
    lines.push(json!({"image_id": "tree.jpg", "category_id": 3, "bbox": [1, 2, 30, 40], "score": 0.5}));
    std::fs::write(&path, Value::from(lines).to_string()).unwrap();
    let (session, given, out) = (skyline(), format!("mine={}", path.display()), folder.path().join("out"));
    let output = done(&["score", text(&session), "--results", &given, "--all", "-o", text(&out)]);
    let cautions = read_json(&out.join("summary.json"))["cautions"].to_string();
    for words in [
        "do not mention 15 of 16 photos (the first: normal_001.jpg)",
        "are also of 1 image that this run does not have (the first: tree.jpg)",
        "have nothing below confidence 0.3: AP counts detections from 0.001 up",
        "more than 100 detections in 1 photo",
        "1 box has no area in the results of mine",
    ] {
        assert!(
            stderr(&output).contains(words) && cautions.contains(words),
            "{words}: {}",
            stderr(&output)
        );
    }
    // Over the border by 20 px: cut there.
    let found = read_json(&out.join("coco_results_mine.json"));
    let cut = |line: &Value| line["score"] == json!(0.4) && line["bbox"] == json!([1200.0, 331.0, 80.0, 315.0]);
    assert!(
        found.as_array().unwrap().len() == 100 && found.as_array().unwrap().iter().any(cut),
        "{found}"
    );
}

#[test]
fn labels_of_their_own_are_named_by_a_list_or_a_coco_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let label_of = |results: &Value, categories: &str| {
        std::fs::write(at("results.json"), results.to_string()).unwrap();
        std::fs::write(at("categories"), categories).unwrap();
        let (session, given, out) = (skyline(), format!("mine={}", at("results.json").display()), at("out"));
        let list = at("categories");
        done(&[
            "score",
            text(&session),
            "--results",
            &given,
            "--categories",
            text(&list),
            "-o",
            text(&out),
        ]);
        let rows = csv::Reader::from_path(out.join("photos.csv"))
            .unwrap()
            .into_deserialize::<std::collections::BTreeMap<String, String>>()
            .next();
        let row = rows.unwrap().unwrap();
        (row["verdict"].clone(), row["other_label"].clone())
    };
    // The model's own box in the first photo.
    let mut on_model = line([474.93, 331.5, 306.37, 315.76], 0.9);
    let mut verdict = |category: u64, categories: &str| {
        on_model["category_id"] = category.into();
        label_of(&json!([on_model]), categories)
    };
    let hit = ("found".to_owned(), String::new());
    assert_eq!(verdict(2, "tree\ncar\n"), hit);
    assert_eq!(verdict(1, "tree\ncar\n"), ("missed".into(), "tree".into()));
    let coco = r#"{"categories": [{"id": 40, "name": "car"}, {"id": 7, "name": "tree"}]}"#;
    assert_eq!(verdict(40, coco), hit);
    assert_eq!(verdict(7, coco), ("missed".into(), "tree".into()));
}

#[test]
fn a_session_is_exported_for_other_programs() {
    let desk = Desk::new();
    let session = skyline();
    let truth = read_json(&desk.at("report/coco_truth.json"));
    let coco = desk.at("coco");
    let output = done(&[
        "session",
        "export",
        text(&session),
        "--format",
        "coco",
        "-o",
        text(&coco),
    ]);
    assert!(
        stdout(&output).contains("16 photos; run the other program on"),
        "{}",
        stdout(&output)
    );
    let page = read_json(&coco.join("annotations.json"));
    for key in ["images", "annotations"] {
        assert_eq!(page[key], truth[key], "{key}");
    }
    let categories = page["categories"].as_array().unwrap();
    assert!(categories.len() == 80 && categories[2] == json!({"id": 3, "name": "car"}));
    let photo = coco.join("images/normal_003.jpg");
    assert!(
        photo.is_symlink() && photo.canonicalize().unwrap() == session.join("normal_003.jpg").canonicalize().unwrap()
    );
    // It is what results refer to.
    let given = for_all(|d| desk.at(&format!("report/coco_results_{d}.json")));
    let images = coco.join("annotations.json");
    assert_same(
        &desk.at("report"),
        &score_with(&desk, "back", &given, &["--images", text(&images)]),
    );

    let yolo = desk.at("yolo");
    done(&[
        "session",
        "export",
        text(&session),
        "--format",
        "yolo",
        "--copy",
        "-o",
        text(&yolo),
    ]);
    let photo = yolo.join("images/normal_003.jpg");
    assert!(
        !photo.is_symlink() && std::fs::read(&photo).unwrap() == std::fs::read(session.join("normal_003.jpg")).unwrap()
    );
    let label = std::fs::read_to_string(yolo.join("labels/normal_003.txt")).unwrap();
    let numbers: Vec<f64> = label.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let bbox = truth["annotations"][3]["bbox"].as_array().unwrap();
    let bbox: Vec<f64> = bbox.iter().map(|v| v.as_f64().unwrap()).collect();
    let wanted = [
        2.0,
        (bbox[0] + bbox[2] / 2.0) / 1280.0,
        (bbox[1] + bbox[3] / 2.0) / 960.0,
        bbox[2] / 1280.0,
        bbox[3] / 960.0,
    ];
    assert!(
        numbers.len() == 5 && numbers.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-8),
        "{label}"
    );
    let list = std::fs::read_to_string(yolo.join("images.txt")).unwrap();
    assert!(list.lines().count() == 16 && list.starts_with("./images/normal_000.jpg\n"));
    let data = std::fs::read_to_string(yolo.join("data.yaml")).unwrap();
    assert!(
        data.starts_with("train: images\nval: images\nnames:\n  0: \"person\"\n") && data.contains("  2: \"car\"\n")
    );

    let again = run(&[
        "session",
        "export",
        text(&session),
        "--format",
        "coco",
        "-o",
        text(&yolo),
    ]);
    assert_refused(&again, &["yolo has files already: name a new folder"]);
}

#[test]
fn photos_that_are_called_alike_get_their_folders_into_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (texture, from) in [("plain", "normal_000.jpg"), ("painted", "random_008.jpg")] {
        std::fs::create_dir(at(texture)).unwrap();
        std::fs::copy(skyline().join(from), at(texture).join("a.jpg")).unwrap();
    }
    let [plain, painted] = ["normal=plain", "random=painted"].map(|pair| {
        let (variant, name) = pair.split_once('=').unwrap();
        format!("{variant}={}", at(name).display())
    });
    let (scene, camera) = (skyline().join("scene.toml"), skyline().join("camera.yaml"));
    let session = at("session");
    done(&[
        "session",
        "new",
        text(&session),
        &plain,
        &painted,
        "--scene",
        text(&scene),
        "--camera",
        text(&camera),
    ]);
    let out = at("out");
    done(&[
        "session",
        "export",
        text(&session),
        "--format",
        "yolo",
        "-o",
        text(&out),
    ]);
    let names = |folder: PathBuf| {
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(out.join("images")), ["painted_a.jpg", "plain_a.jpg"]);
    assert_eq!(names(out.join("labels")), ["painted_a.txt", "plain_a.txt"]);
    // And are known by them.
    let labels = at("labels");
    std::fs::create_dir(&labels).unwrap();
    std::fs::write(labels.join("plain_a.txt"), "2 0.5 0.5 0.2 0.2 0.9\n").unwrap();
    let (given, report) = (format!("mine={}", labels.display()), at("report"));
    let output = done(&["score", text(&session), "--results", &given, "-o", text(&report)]);
    assert!(
        stderr(&output).contains("1 of 2 photos (the first: ../painted/a.jpg)"),
        "{}",
        stderr(&output)
    );
    // Their own name alone says too little.
    std::fs::rename(labels.join("plain_a.txt"), labels.join("a.txt")).unwrap();
    let refused = run(&["score", text(&session), "--results", &given, "-o", text(&report)]);
    assert_refused(
        &refused,
        &["a.txt may be ../plain/a.jpg or ../painted/a.jpg: name it with its folder"],
    );
}
