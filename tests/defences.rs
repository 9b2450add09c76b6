//! `score --defence`: images changed as the papers' own code changes them, drops that are held against those without a defence, and programs of one's own.

use crate::common;
use crate::corruptions::Table;

use common::{assert_refused, home, program, read_json, skyline, stderr, stdout};
use serde_json::{Value, json};

use scaleproof_photo::defence::Defence;

/// Byte for byte, but for JPEG, whose encoders round differently: `tests/data/make_defences.py` made the images with others' code.
#[test]
fn images_are_changed_as_published() {
    let open = |name: &str| image::open(home().join("tests/data").join(name)).unwrap().into_rgb8();
    let piece = open("corruptions/piece.png");
    for (name, theirs) in [
        ("median", "median_2"),
        ("median=3", "median_3"),
        ("median=4", "median_4"),
        ("bit-depth", "bit_depth_3"),
        ("bit-depth=5", "bit_depth_5"),
        ("jpeg", "jpeg_75"),
    ] {
        let defence = Defence::named(name).unwrap();
        let frames = defence.frames(piece.dimensions().into(), 1);
        let own = defence.image(&piece, &frames[0]).unwrap();
        let theirs = open(&format!("defences/{theirs}.png"));
        if name == "jpeg" {
            let off = own.iter().zip(theirs.iter()).map(|(a, b)| f64::from(a.abs_diff(*b)));
            let mean = off.sum::<f64>() / own.len() as f64;
            println!("jpeg: off by {mean:.3} on average");
            assert!(mean < 0.2, "{mean}");
        } else {
            assert!(own == theirs, "{name}");
        }
    }
}

/// A program that changes images: its loop has the number of the request in `id` and of bytes in `bytes`.
fn defence(table: &Table, name: &str, answer: &str) -> String {
    let hello = format!(r#"{{"scaleproof_defence": 1, "name": "{name}", "version": "1", "deterministic": true}}"#);
    let script = format!(
        r#"echo '{hello}'
while read -r line; do
  id=${{line#*\"id\":}}; id=${{id%%[,\}}]*}}; bytes=${{line#*\"bytes\":}}; bytes=${{bytes%%[,\}}]*}}
  head -c "$bytes" > '{pixels}'.$$
  {answer}
done
"#,
        pixels = table.at(name).display(),
    );
    std::fs::write(table.at(&format!("{name}.sh")), script).unwrap();
    format!("exec:bash {}", table.at(&format!("{name}.sh")).display())
}

/// All pixels of the table's photos as light as the plain model's.
const LIGHTEN: &str = r#"echo "{\"id\": $id, \"shape\": [150, 200, 3]}"; head -c "$bytes" /dev/zero | tr '\0' '\310'"#;

fn rows<'a>(summary: &'a Value, what: &str, defence: &str) -> Vec<&'a Value> {
    let all = summary["defences"][what].as_array().unwrap();
    all.iter().filter(|row| row["defence"] == defence).collect()
}

#[test]
fn a_drop_is_what_is_left_of_it_under_each_defence() {
    let table = Table::new([("normal", 200), ("camo", 90)]);
    let lighten = defence(&table, "lighten", LIGHTEN);
    let names = format!("jpeg=50,crops=4,{lighten}");
    let said = stdout(&table.scored("out", &["--defence", &names]));
    let line = said
        .lines()
        .filter(|line| line.starts_with("light "))
        .collect::<Vec<_>>();
    assert!(
        line.iter()
            .any(|line| line.contains("1.00 → 0.00") && line.contains("1.00 → 1.00")),
        "{said}"
    );
    let summary = read_json(&table.at("out/summary.json"));
    for (name, left) in [("none", 0.0), ("jpeg=50", 0.0), ("crops=4", 0.0), ("lighten", 1.0)] {
        let own = rows(&summary, "rows", name);
        assert_eq!(own.len(), 1, "{name}");
        assert_eq!(
            [&own[0]["ap50"]["base"], &own[0]["ap50"]["other"]],
            [&json!(1.0), &json!(left)],
            "{name}"
        );
        assert_eq!(own[0]["pairs"], 8);
    }
    // Of the dark photos the program makes light ones: it gives back all, and takes nothing from the others.
    for (name, camo, normal) in [("jpeg=50", 0.0, 0.0), ("crops=4", 0.0, 0.0), ("lighten", 1.0, 0.0)] {
        let changes = rows(&summary, "changes", name);
        let added = |variant: &str| {
            let row = changes.iter().find(|row| row["variant"] == variant).unwrap();
            assert_eq!((&row["base"], &row["pairs"]), (&json!("none"), &json!(8)));
            -row["ap50"]["drop"].as_f64().unwrap()
        };
        assert_eq!([added("camo"), added("normal")], [camo, normal], "{name}");
    }
    assert_eq!(
        rows(&summary, "changes", "lighten")[1]["finding"]["effect"],
        "strengthens",
        "{summary}"
    );
    let lines = csv::Reader::from_path(table.at("out/defences.csv"))
        .unwrap()
        .into_records()
        .count();
    assert_eq!(lines, 4 + 6);
    let page = std::fs::read_to_string(table.at("out/report.html")).unwrap();
    assert!(page.contains("On defended photos") && page.contains("Guo et al. 2018"));
    let tex = std::fs::read_to_string(table.at("out/defences.tex")).unwrap();
    assert!(
        tex.contains("jpeg=50") && tex.contains("labels of a box: given"),
        "{tex}"
    );

    // What was found is kept, the same bytes come out, and a report without it leaves nothing of it behind.
    let asked = table.asked();
    assert_eq!(
        asked,
        16 * (1 + 1 + 1 + 4 + 1),
        "each photo twice, compressed, four crops, and lightened"
    );
    table.scored("again", &["--defence", &names]);
    assert_eq!(table.asked(), asked);
    let read = |name: &str| std::fs::read(table.at(name)).unwrap();
    for file in ["summary.json", "defences.csv", "report.html"] {
        assert!(read(&format!("out/{file}")) == read(&format!("again/{file}")), "{file}");
    }
    table.scored("out", &[]);
    assert_eq!(read_json(&table.at("out/summary.json"))["defences"], Value::Null);
    assert!(!table.at("out/defences.csv").exists() && !table.at("out/defences.tex").exists());
}

#[test]
fn a_program_that_cannot_be_used_ends_the_run_in_one_sentence() {
    let table = Table::new([("normal", 200), ("camo", 90)]);
    for (name, answer, words) in [
        (
            "dies",
            "echo 'no weights' >&2; exit 3",
            &["ended with exit code 3", "no weights"][..],
        ),
        (
            "smaller",
            r#"echo "{\"id\": $id, \"shape\": [75, 100, 3]}""#,
            &["smaller", "shape [75, 100, 3]", "[150, 200, 3]"],
        ),
        (
            "boxes",
            r#"echo "{\"id\": $id, \"detections\": []}""#,
            &["which is no answer", "detections"],
        ),
        (
            "halts",
            r#"echo "{\"id\": $id, \"shape\": [150, 200, 3]}"; sleep 60"#,
            &["within 1 s"],
        ),
    ] {
        let program = defence(&table, name, answer);
        let output = table.score("out", &["--defence", &program, "--detector-timeout", "1"]);
        assert_refused(&output, words);
    }
    // A photo that a program declines is left out, and said.
    let declines = defence(
        &table,
        "declines",
        r#"echo "{\"id\": $id, \"error\": \"nothing to do\"}""#,
    );
    let output = table.scored("out", &["--defence", &declines]);
    assert!(
        stderr(&output).contains("16 of 32 images defended are in no comparison"),
        "{}",
        stderr(&output)
    );
    assert!(stderr(&output).contains("nothing to do"));
}

#[test]
fn what_cannot_be_defended_is_refused_before_the_work() {
    let table = Table::new([("normal", 200), ("camo", 90)]);
    assert_refused(
        &table.score("out", &["--defence", "quilting"]),
        &["quilting", "jpeg", "resize-pad"],
    );
    assert_refused(
        &table.score("out", &["--defence", "jpeg,jpeg=75"]),
        &["two defences are called jpeg=75"],
    );
    assert_refused(
        &table.score("out", &["--defence", "jpeg", "--shard", "1/2"]),
        &["--defence", "cannot be used with", "--shard"],
    );
    let detector = format!("exec:bash {}", table.at("light.sh").display());
    assert_refused(
        &table.score("out", &["--defence", &detector]),
        &["its hello is not valid", "scaleproof_defence"],
    );
    assert_eq!(table.asked(), 0);
    let mut command = program();
    command
        .arg("score")
        .arg(skyline())
        .args(["--recorded", "--defence", "jpeg", "-o"]);
    let output = command.arg(table.at("out")).output().unwrap();
    assert_refused(
        &output,
        &["cannot look at photos that are defended", "stored detections"],
    );
    assert!(!table.at("out").exists());
}

/// The project's own detector finds the plain car under every defence, where it is: boxes come back from padded and cropped images to the photo. Twice the
/// same, whatever runs side by side.
#[test]
fn a_network_finds_the_plain_car_under_every_defence() {
    let folder = tempfile::tempdir().unwrap();
    let summary = |threads: &str| {
        let out = folder.path().join(threads);
        let mut command = program();
        command
            .arg("score")
            .arg(skyline())
            .arg("--detector")
            .arg(home().join("detectors/scaleproof_car.toml"));
        command.args([
            "--defence",
            "jpeg,bit-depth,median,resize-pad,crops=3",
            "--threads",
            threads,
        ]);
        command
            .arg("--cache")
            .arg(folder.path().join(format!("cache_{threads}")))
            .arg("-o")
            .arg(&out);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        std::fs::read_to_string(out.join("summary.json")).unwrap()
    };
    let text = summary("1");
    assert!(text == summary("2"), "the same photos give the same figures");
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["box_labels"], json!({"scaleproof_car": "best"}));
    for row in summary["defences"]["rows"].as_array().unwrap() {
        let base = row["ap50"]["base"].as_f64().unwrap();
        assert!(base >= 0.9, "{row}");
    }
}
