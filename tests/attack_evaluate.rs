//! Patterns judged on rendered photos, with a program that stands in for Blender: truth boxes against an own projection and Blender's masks, the
//! tables against figures by hand, resume, and what is refused.
#![cfg(unix)]

use crate::common;
use crate::common::onnx;

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, home, program, read_json, shared, stderr, stdout};
use scaleproof_frames::FrameSet;
use scaleproof_frames::light;
use scaleproof_session::Session;
use scaleproof_surface::pattern::Pattern;

/// Length, width, height of the test's model.
const SIZE_MM: [f64; 3] = [180.0, 90.0, 60.0];

/// Stands in for Blender: copies the images that lie ready beside it, or black ones, and stops after the first when it is told to.
const STAND_IN: &str = r#"#!/bin/sh
if [ "$1" = -c ]; then echo 3.11; exit 0; fi
here=$(dirname "$0"); raw=$(dirname "$2"); echo run >> "$here/runs"; cp "$2" "$here/plan.json"
for name in $(grep -o '"name":"[^"]*","paint"' "$2" | sed 's/"name":"//; s/","paint"//'); do
  if [ -e "$here/ready/$name.f32" ]; then cp "$here/ready/$name.f32" "$raw/$name.rgb.f32"
  else head -c "$(cat "$here/bytes")" /dev/zero > "$raw/$name.rgb.f32"; fi
  echo "frame $name"
  if [ -e "$here/weak" ]; then rm "$here/weak"; echo "no memory" >&2; exit 1; fi
done
"#;

/// A folder with a model, two patterns, the stand-in and a detector that always gives the same box.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new(found_px: [f64; 4]) -> Bench {
        let bench = Bench {
            folder: tempfile::tempdir().unwrap(),
        };
        std::fs::write(bench.at("box.stl"), box_stl()).unwrap();
        for seed in [1, 2] {
            let pattern = Pattern::random(4, seed).unwrap().to_png().unwrap();
            std::fs::write(bench.at(&format!("p{seed}.png")), pattern).unwrap();
        }
        std::fs::write(bench.at("python"), STAND_IN).unwrap();
        std::fs::set_permissions(bench.at("python"), std::fs::Permissions::from_mode(0o755)).unwrap();
        std::fs::write(bench.at("bytes"), (64 * 64 * 12).to_string()).unwrap();
        std::fs::create_dir_all(bench.at(".cache/bpy-4.5")).unwrap();
        bench.write_detector(found_px);
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A network for images of 64×64 px that finds a car with confidence 0.8, whatever it sees.
    fn write_detector(&self, [x1, y1, x2, y2]: [f64; 4]) {
        let answer = [x1, y1, x2, y2, 0.8, 2.0].map(|v| v as f32).to_vec();
        let network = onnx::network(
            &[onnx::Input::floats("images", &[1, 3, 64, 64])],
            &[onnx::Output::floats("output0", &[1, 1, 6], answer)],
        );
        let hash = scaleproof_core::files::sha256_hex(&network);
        std::fs::write(self.at("made.onnx"), network).unwrap();
        for name in ["made", "other"] {
            let manifest = format!(
                "name = \"{name}\"\ntitle = \"The {name}\"\nlicence = \"none\"\norigin = \"this test\"\nlabels = \"coco80\"\n[weights]\n\
                 file = \"made.onnx\"\nsha256 = \"{hash}\"\n[input]\nsize_px = [64, 64]\nresize = \"stretch\"\nkernel = \"opencv_linear\"\n\
                 channels = \"rgb\"\nmean = [0.0, 0.0, 0.0]\nstd = [255.0, 255.0, 255.0]\n[head]\nkind = \"yolov10\"\n"
            );
            std::fs::write(self.at(&format!("{name}.toml")), manifest).unwrap();
        }
    }

    /// The evaluation of both patterns from two distances.
    fn run(&self, more: &[&str]) -> Output {
        let at = |name: &str| self.at(name).display().to_string();
        let mut command = program();
        command
            .env("SCALEPROOF_PYTHON", self.at("python"))
            .env("SCALEPROOF_HOME", self.folder.path());
        let fixed = "attack evaluate --normal 808080 --tile-mm 60 --size-px 64 --field-of-view-deg 50 --light forest --azimuth-deg 0 \
                     --pitch-deg 15 --distance-mm 400 900";
        command.args(fixed.split_whitespace());
        command.args(["--mesh", &at("box.stl"), "-o", &at("out"), "--cache", &at("cache")]);
        command.args([
            "--detector",
            &at("made.toml"),
            "--detector",
            &at("other.toml"),
            "--pattern",
        ]);
        command.args([format!("one={}", at("p1.png")), format!("two={}", at("p2.png"))]);
        command.args(more).output().unwrap()
    }

    fn runs(&self) -> usize {
        std::fs::read_to_string(self.at("runs")).map_or(0, |text| text.lines().count())
    }
}

fn corners() -> [[f64; 3]; 8] {
    std::array::from_fn(|i| {
        let end = |axis: usize| if i >> axis & 1 == 1 { 1.0 } else { 0.0 };
        [
            (end(0) - 0.5) * SIZE_MM[0],
            (end(1) - 0.5) * SIZE_MM[1],
            end(2) * SIZE_MM[2],
        ]
    })
}

/// All six faces, outwards.
fn box_stl() -> String {
    let points = corners();
    let mut text = String::from("solid box\n");
    for [a, b, c, d] in common::BOX_FACES {
        for triangle in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for i in triangle {
                let [x, y, z] = points[i];
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid box\n"
}

/// Where a camera in front of the box (azimuth 0, looking down by 15°) sees it, from the corner of the top-left pixel: 64 px, 50° wide.
fn seen_px(distance_mm: f64) -> [f64; 4] {
    let (sin, cos) = 15_f64.to_radians().sin_cos();
    let focal = 32.0 / 25_f64.to_radians().tan();
    let points = corners().map(|[x, y, z]| {
        let height = z - 0.5 * SIZE_MM[2];
        let depth = distance_mm - x * cos - height * sin;
        let up = height * cos - x * sin;
        [32.0 + focal * y / depth, 32.0 - focal * up / depth]
    });
    let over = |axis: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[axis]).reduce(pick).unwrap();
    [
        over(0, f64::min),
        over(1, f64::min),
        over(0, f64::max),
        over(1, f64::max),
    ]
}

#[test]
fn photos_become_a_session_with_exact_truth_and_the_papers_tables() {
    let bench = Bench::new(seen_px(400.0));
    let output = bench.run(&["--target", "made"]);
    assert!(output.status.success(), "{}", stderr(&output));

    let session = Session::open(&bench.at("out/session")).unwrap();
    assert_eq!(session.photos.len(), 6);
    assert_eq!(session.scene.model.size_mm, SIZE_MM);
    for photo in &session.photos {
        let view = photo.viewpoint.unwrap();
        let truth = photo.box_xyxy_px.unwrap();
        let own = seen_px(view.distance_mm);
        let truth = [truth.x1, truth.y1, truth.x2, truth.y2];
        let off = truth.iter().zip(own).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6, "{truth:?} and not {own:?}");
        assert_eq!((view.azimuth_deg, view.pitch_deg), (0.0, 15.0));
        assert_eq!(photo.place.as_deref(), Some("forest@0"));
        let size = image::image_dimensions(session.photo_path(photo)).unwrap();
        assert_eq!(size, (64, 64));
    }
    let variants: Vec<&str> = session.photos.iter().map(|p| p.variant.as_str()).collect();
    assert_eq!(variants, ["normal", "normal", "one", "one", "two", "two"]);

    // One of two photos is hit, by a detection that is as confident as the miss beside it: recall 0.5 at precision 1, so that
    // 51 of COCO's 101 recalls count. The mean confidence is (0.8 + 0) / 2.
    let text = stdout(&output);
    let after = |title: &str| {
        text.split_once(title)
            .unwrap_or_else(|| panic!("{title} is not in {text}"))
            .1
            .to_owned()
    };
    let rows = |part: &str| part.lines().skip(1).take(4).map(words).collect::<Vec<_>>();
    assert_eq!(
        rows(&after("Table 1.")),
        [
            words("pattern The made conf."),
            words("normal 0.50 0.40"),
            words("one 0.50 0.40"),
            words("two 0.50 0.40")
        ]
    );
    assert_eq!(
        rows(&after("Table 2.")),
        [
            words("pattern The other"),
            words("normal 0.50"),
            words("one 0.50"),
            words("two 0.50")
        ]
    );
    assert!(
        text.contains("one − two"),
        "patterns are held against each other: {text}"
    );
    assert!(text.contains("nothing shown"), "{text}");

    let mut figures = csv::Reader::from_path(bench.at("out/evaluation.csv")).unwrap();
    let figures: Vec<csv::StringRecord> = figures.records().map(Result::unwrap).collect();
    assert_eq!(figures.len(), 6);
    let row: Vec<&str> = figures[0].iter().collect();
    assert_eq!(row[..4], ["1", "normal", "made", "2"]);
    assert_eq!(row[4..6], ["coco-101", "listed"], "YOLOv10 lists its boxes");
    assert!((row[6].parse::<f64>().unwrap() - 51.0 / 101.0).abs() < 1e-12, "{row:?}");
    let differences = std::fs::read_to_string(bench.at("out/differences.csv")).unwrap();
    // normal-one, normal-two, one-two × two detectors × three figures, and the heading.
    assert_eq!(differences.lines().count(), 19, "{differences}");
    for file in [
        "evaluation.html",
        "evaluation.tex",
        "score/report.html",
        "score/summary.json",
    ] {
        assert!(bench.at("out").join(file).is_file(), "{file}");
    }
    let page = std::fs::read_to_string(bench.at("out/evaluation.html")).unwrap();
    for part in [
        "Table 1",
        "The made",
        "Table 2",
        "The other",
        "Differences",
        "<td class=\"text\">one</td>",
        "<td>0.50</td>",
        "nothing shown",
    ] {
        assert!(page.contains(part), "{part} is not on the page");
    }
    // Each pattern is there to the cell, with its hash and size, and all three paints with a strip of their two photos.
    for seed in [1, 2] {
        let png = std::fs::read(bench.at(&format!("p{seed}.png"))).unwrap();
        assert!(
            page.contains(&format!("p{seed}.png: 4 × 4 cells, a repeat 60 mm wide")),
            "{seed}"
        );
        assert!(page.contains(&scaleproof_core::files::sha256_hex(&png)), "{seed}");
    }
    assert_eq!(page.matches("data:image/png;base64,").count(), 2);
    // All six photos in the strips, and again, each once, where the first screen has them side by side.
    assert_eq!(page.matches("data:image/jpeg;base64,").count(), 2 * 3 * 2);
    // What was rendered is scored by the ordinary command, too.
    let mut score = program();
    score
        .arg("score")
        .arg(bench.at("out/session"))
        .arg("--out")
        .arg(bench.at("again"));
    let output = score.arg("--detector").arg(bench.at("made.toml")).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(read_json(&bench.at("again/summary.json"))["photos_scored"], 6);
}

fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(str::to_owned).collect()
}

#[test]
fn an_evaluation_goes_on_where_it_stopped_and_takes_further_patterns() {
    let bench = Bench::new([8.0, 8.0, 56.0, 56.0]);
    std::fs::write(bench.at("weak"), "").unwrap();
    assert_refused(
        &bench.run(&[]),
        &["stopped after 1 of 6", "blender.log", "goes on where it stopped"],
    );
    assert!(!bench.at("out/session/session.json").exists(), "the list comes last");
    assert!(!bench.at("out/evaluation.html").exists());

    let finished = bench.run(&[]);
    assert!(finished.status.success(), "{}", stderr(&finished));
    let asked = read_json(&bench.at("plan.json"));
    assert_eq!(asked["denoise"], true);
    let frames: usize = asked["views"]
        .as_array()
        .unwrap()
        .iter()
        .map(|v| v["frames"].as_array().unwrap().len())
        .sum();
    assert_eq!(frames, 5, "the whole photo is not rendered again");
    assert_eq!(bench.runs(), 2);
    let first = std::fs::read(bench.at("out/evaluation.html")).unwrap();

    // All is there: Blender is not needed, and the same comes out.
    std::fs::remove_file(bench.at("python")).unwrap();
    let again = bench.run(&[]);
    assert!(again.status.success(), "{}", stderr(&again));
    assert_eq!(std::fs::read(bench.at("out/evaluation.html")).unwrap(), first);

    // One more pattern is all that Blender is asked for.
    let three = format!("three={}", bench.at("p1.png").display());
    assert_refused(&bench.run(&["--pattern", &three]), &["python", "does not start"]);
    std::fs::write(bench.at("python"), STAND_IN).unwrap();
    std::fs::set_permissions(bench.at("python"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let more = bench.run(&["--pattern", &three]);
    assert!(more.status.success(), "{}", stderr(&more));
    assert!(stdout(&more).contains("three"));
    assert_eq!(
        read_json(&bench.at("plan.json"))["paints"].as_object().unwrap().len(),
        4
    );
    assert_eq!(Session::open(&bench.at("out/session")).unwrap().photos.len(), 8);
}

/// A run's folder: a pattern of the bench, and that it took so many seconds.
fn write_run(bench: &Bench, (name, pattern): (&str, &str), (tile_mm, wall_s): (f64, f64)) {
    let folder = bench.at(name);
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(bench.at(pattern), folder.join("pattern.png")).unwrap();
    let judged = serde_json::json!({"views": 4, "ap50": 0.9, "hit_rate": 0.8, "mean_confidence": 0.6});
    let entry = serde_json::json!({"step": 9, "queries": 72, "wall_s": wall_s, "loss": 4.1, "confidence": 0.1, "held_out": judged});
    let history = serde_json::json!({
        "scaleproof": "0.1.0", "method": "dta", "seed": 1, "tile_mm": tile_mm, "frames_sha256": "0", "detectors": ["made 0"], "entries": [entry],
    });
    std::fs::write(folder.join("history.json"), history.to_string()).unwrap();
}

#[test]
fn rendered_figures_are_drawn_against_the_time_of_the_runs() {
    let bench = Bench::new(seen_px(400.0));
    assert!(bench.run(&[]).status.success());
    write_run(&bench, ("quick", "p2.png"), (60.0, 5.0));
    write_run(&bench, ("slow", "p1.png"), (60.0, 50.0));
    let history = |runs: &[&str]| {
        let mut command = program();
        command
            .current_dir(bench.folder.path())
            .args(["attack", "history"])
            .args(runs);
        command.args(["--evaluation", "out", "-o", "chart"]).output().unwrap()
    };
    let drawn = history(&["quick", "slow", "--json"]);
    assert!(drawn.status.success(), "{}", stderr(&drawn));
    let json: serde_json::Value = serde_json::from_slice(&drawn.stdout).unwrap();
    for (run, seconds) in json["rendered"].as_array().unwrap().iter().zip([5.0, 50.0]) {
        assert_eq!(
            (run["wall_s"].as_f64(), run["queries"].as_u64()),
            (Some(seconds), Some(72))
        );
        for (figures, detector) in run["rendered"].as_array().unwrap().iter().zip(["made", "other"]) {
            // As in the tables above, and not the 0.9 that was predicted.
            assert_eq!(figures["detector"], detector);
            assert_eq!(
                (figures["photos"].as_u64(), figures["hit_rate"].as_f64()),
                (Some(2), Some(0.5))
            );
            assert!(
                (figures["ap50"].as_f64().unwrap() - 51.0 / 101.0).abs() < 1e-12,
                "{figures}"
            );
        }
    }
    assert_eq!(read_json(&bench.at("chart/rendered.json")), json["rendered"]);
    let chart = std::fs::read_to_string(bench.at("chart/rendered.svg")).unwrap();
    // Both patterns do the same: of each detector's two marks the quicker one is ringed. One ring more explains it.
    assert_eq!(chart.matches("r=\"10.5\"").count(), 2, "{chart}");
    assert!(stdout(&history(&["slow"])).contains("rendered:"));
    // What counted as the model must be the same.
    let path = bench.folder.path().join("slow/history.json");
    let mut of_trucks = read_json(&path);
    of_trucks["classes"] = "truck".into();
    std::fs::write(&path, of_trucks.to_string()).unwrap();
    assert_refused(&history(&["quick", "slow"]), &["other classes (not stated; truck)"]);

    // Figures that no run has are not drawn.
    for (name, value) in [("wall_s", -5.0), ("wall_s", 1e300)] {
        let mut impossible = of_trucks.clone();
        impossible["entries"][0][name] = value.into();
        std::fs::write(&path, impossible.to_string()).unwrap();
        assert_refused(&history(&["slow"]), &["slow/history.json", name, "make it again"]);
    }
    for name in ["ap50", "hit_rate", "mean_confidence"] {
        let mut impossible = of_trucks.clone();
        impossible["entries"][0]["held_out"][name] = 1.5.into();
        std::fs::write(&path, impossible.to_string()).unwrap();
        assert_refused(&history(&["slow"]), &["slow/history.json", name, "1.5"]);
    }

    std::fs::write(&path, of_trucks.to_string()).unwrap();
    assert_refused(
        &history(&["slow"]),
        &[
            "out counted car as the model",
            "slow/pattern.png was made for truck",
            "hint: these are --class",
        ],
    );
    assert_refused(
        &history(&["quick", "./quick"]),
        &["quick and ./quick are the same result"],
    );
    let mut unjudged = of_trucks.clone();
    unjudged["entries"][0]["held_out"] = serde_json::Value::Null;
    std::fs::write(&path, unjudged.to_string()).unwrap();
    assert_refused(&history(&["slow"]), &["slow has no figures of held-out views"]);
    // A pattern that was put in another's place, as the card of the first one tells.
    write_run(&bench, ("exchanged", "p1.png"), (60.0, 5.0));
    let other = scaleproof_core::files::sha256_hex(&std::fs::read(bench.at("p2.png")).unwrap());
    let card = |sides: bool, sha256: &str| {
        let card = serde_json::json!({"pattern_sha256": sha256, "tile_mm": 60.0, "sides": sides});
        std::fs::write(bench.at("exchanged/pattern.json"), card.to_string()).unwrap();
    };
    card(false, &other);
    assert_refused(&history(&["exchanged"]), &["exchanged/pattern.json", "another pattern"]);
    card(
        true,
        &scaleproof_core::files::sha256_hex(&std::fs::read(bench.at("p1.png")).unwrap()),
    );
    assert_refused(
        &history(&["exchanged"]),
        &["exchanged/pattern.png has cells for each side"],
    );

    write_run(&bench, ("wide", "p1.png"), (80.0, 5.0));
    assert_refused(
        &history(&["wide"]),
        &["out has no photos of wide/pattern.png repeated every 80 mm"],
    );
    std::fs::write(bench.at("p3.png"), Pattern::random(4, 3).unwrap().to_png().unwrap()).unwrap();
    write_run(&bench, ("new", "p3.png"), (60.0, 5.0));
    assert_refused(&history(&["quick", "new"]), &["out has no photos of new/pattern.png"]);
    // A chart of photos that an earlier call drew is not left beside the new one.
    assert!(bench.at("chart/rendered.svg").exists());
    let mut without = program();
    without
        .current_dir(bench.folder.path())
        .args(["attack", "history", "quick", "-o", "chart"]);
    assert!(without.output().unwrap().status.success());
    assert!(!bench.at("chart/rendered.svg").exists() && !bench.at("chart/rendered.json").exists());

    let mut summary = read_json(&bench.at("out/score/summary.json"));
    summary["results"][0]["overall"]["ap50"] = 7.5.into();
    std::fs::write(bench.at("out/score/summary.json"), summary.to_string()).unwrap();
    assert_refused(
        &history(&["quick"]),
        &["summary.json is not of a finished evaluation", "its ap50 is 7.5"],
    );
    std::fs::write(bench.at("out/score/summary.json"), "{}").unwrap();
    assert_refused(
        &history(&["quick"]),
        &["summary.json is not of a finished evaluation", "missing field"],
    );
}

/// The box of [`box_stl`] with texture coordinates, whose image has these pixels.
fn write_textured(bench: &Bench, pixels: [[u8; 3]; 2]) {
    let mut text = String::from("mtllib worn.mtl\nusemtl worn\n");
    let stl = box_stl();
    for line in stl.lines().filter(|line| line.starts_with("vertex")) {
        text += &line.replace("vertex", "v");
        text += "\n";
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\n";
    for i in 0..12 {
        let first = 3 * i + 1;
        text += &format!("f {first}/1 {}/2 {}/3\n", first + 1, first + 2);
    }
    std::fs::write(bench.at("worn.obj"), text).unwrap();
    std::fs::write(bench.at("worn.mtl"), "newmtl worn\nmap_Kd worn.png\n").unwrap();
    let image = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(pixels[x as usize]));
    image.save(bench.at("worn.png")).unwrap();
}

#[test]
fn textures_are_judged_beside_patterns() {
    let bench = Bench::new([8.0, 8.0, 56.0, 56.0]);
    write_textured(&bench, [[10, 20, 30], [200, 100, 0]]);
    let worn = format!("worn={}", bench.at("worn.obj").display());
    let output = bench.run(&["--texture", &worn]);
    assert!(output.status.success(), "{}", stderr(&output));
    let session = Session::open(&bench.at("out/session")).unwrap();
    let variants: Vec<&str> = session.photos.iter().map(|p| p.variant.as_str()).collect();
    assert_eq!(variants[4..], ["two", "two", "worn", "worn"]);
    assert!(stdout(&output).contains("two − worn"));

    // Blender gets the image as it is, and where each triangle lies in it.
    let plan = read_json(&bench.at("plan.json"));
    let texture = &plan["paints"]["worn"]["texture"];
    let uv = texture["uv"].as_array().unwrap();
    assert_eq!(uv.len(), plan["paint_surface"]["triangles"].as_array().unwrap().len());
    assert!(
        uv.iter()
            .all(|triangle| *triangle == serde_json::json!([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    );
    assert_eq!(texture["extension"], "REPEAT");
    let image = image::open(texture["file"].as_str().unwrap()).unwrap().to_rgb8();
    assert_eq!(image.as_raw()[..], [10, 20, 30, 200, 100, 0]);
    let levels = plan["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 256);
    assert!((levels[188].as_f64().unwrap() - 0.5).abs() < 0.005);

    write_textured(&bench, [[10, 20, 30], [200, 100, 1]]);
    assert_refused(
        &bench.run(&["--texture", &worn]),
        &["another pattern, texture or tile", "worn"],
    );
    assert_refused(&bench.run(&["--texture", "nothing.obj"]), &["nothing.obj"]);
}

#[test]
fn a_program_is_judged_beside_networks() {
    let bench = Bench::new([8.0, 8.0, 56.0, 56.0]);
    let hello = r#"{"scaleproof_detector": 1, "name": "same", "version": "1", "labels": ["car"], "input": "path"}"#;
    let script = format!(
        "echo '{hello}'\nwhile read -r line; do id=${{line#*\\\"id\\\":}}\necho \"{{\\\"id\\\": ${{id%%,*}}, \\\"detections\\\": \
         [{{\\\"label\\\": 0, \\\"score\\\": 0.8, \\\"box\\\": [8, 8, 56, 56]}}]}}\"; done\n"
    );
    std::fs::write(bench.at("same.sh"), script).unwrap();
    let detector = format!("exec:sh {}", bench.at("same.sh").display());
    let output = bench.run(&["--detector", &detector, "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let tables: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let of = |detector: &str| -> Vec<String> {
        let results = tables["results"].as_array().unwrap().iter();
        results
            .filter(|r| r["detector"] == detector)
            .map(|r| r["overall"].to_string())
            .collect()
    };
    assert_eq!((of("same").len(), of("same")), (3, of("made")));
    let twice = format!("exec:sh {0} ", bench.at("same.sh").display());
    assert_refused(
        &bench.run(&["--detector", &detector, "--detector", &twice]),
        &["two detectors are called same"],
    );
}

#[test]
fn what_would_give_wrong_tables_is_refused() {
    let bench = Bench::new([8.0, 8.0, 56.0, 56.0]);
    let p1 = bench.at("p1.png").display().to_string();
    let refused = |more: &[&str], words: &[&str]| assert_refused(&bench.run(more), words);
    // A session of real photos stays.
    std::fs::create_dir_all(bench.at("out/session")).unwrap();
    std::fs::write(bench.at("out/session/session.json"), "{}").unwrap();
    refused(&[], &["out/session", "no evaluation made", "another folder"]);
    assert_eq!(std::fs::read(bench.at("out/session/session.json")).unwrap(), b"{}");
    assert_eq!(std::fs::read_dir(bench.at("out/session")).unwrap().count(), 1);
    std::fs::remove_dir_all(bench.at("out")).unwrap();
    refused(&["--pattern", "p.png"], &["'p.png' has no name", "NAME=FILE"]);
    refused(
        &["--pattern", &format!("normal={p1}")],
        &["\"normal\" cannot name a pattern"],
    );
    refused(
        &["--pattern", &format!("one={p1}")],
        &["\"one\" cannot name a pattern", "each name once"],
    );
    refused(
        &["--pattern", &format!("../x={p1}")],
        &["\"../x\" cannot name a pattern"],
    );
    refused(&["--pattern", "x=/nowhere.png"], &["cannot read /nowhere.png"]);
    refused(
        &["--pattern", &format!("x={}", bench.at("box.stl").display())],
        &["box.stl is not a PNG file"],
    );
    refused(&["--target", "yolov4"], &["the target 'yolov4'", "made, other"]);
    refused(&["--distance-mm", "150"], &["not whole in the image", "150 mm"]);
    refused(&["--pitch-deg", "-30"], &["not above the ground"]);
    refused(&["--class", "unicorn"], &["made has no label `unicorn`"]);
    assert!(!bench.at("out").exists(), "nothing was begun");

    assert!(bench.run(&[]).status.success());
    refused(&["--seed", "2"], &["out/session holds frames of another render"]);
    std::fs::copy(bench.at("p2.png"), bench.at("p1.png")).unwrap();
    refused(
        &[],
        &[
            "photos/one holds photos of another pattern, texture or tile",
            "another name",
        ],
    );
    std::fs::write(bench.at("p1.png"), Pattern::random(4, 1).unwrap().to_png().unwrap()).unwrap();
    let before = std::fs::read(bench.at("out/evaluation.csv")).unwrap();
    let photo = bench.at("out/session/photos/two/forest@0_az0_p15_d900.png");
    let whole = std::fs::read(&photo).unwrap();
    std::fs::write(&photo, &whole[..whole.len() / 2]).unwrap();
    refused(
        &[],
        &[
            "az0_p15_d900.png is damaged",
            "remove it, and the same command renders it again",
        ],
    );
    std::fs::write(&photo, std::fs::read(bench.at("p2.png")).unwrap()).unwrap();
    refused(&[], &["az0_p15_d900.png is damaged", "4×4 pixels"]);
    assert_eq!(
        std::fs::read(bench.at("out/evaluation.csv")).unwrap(),
        before,
        "the tables stay"
    );
    std::fs::remove_file(&photo).unwrap();
    assert!(bench.run(&[]).status.success());
    assert_eq!(std::fs::read(&photo).unwrap(), whole);
}

/// The stored frames of the skyline, as if Blender rendered them now: the same images, truth around what Blender's masks show, and scored by a
/// real detector.
#[test]
#[ignore = "needs the shared material: ./run test --shared"]
fn stored_frames_are_scored_with_the_truth_that_their_masks_show() {
    let mesh = shared("meshes/skyline_r32_lowpoly_ccby4.glb");
    let bench = Bench::new([0.0; 4]);
    let set = FrameSet::open(&home().join("captures/skyline_frames")).unwrap();
    std::fs::create_dir(bench.at("ready")).unwrap();
    for frame in &set.list.frames {
        let linear = set
            .rgb(frame)
            .unwrap()
            .pixels()
            .flat_map(|p| light::linear_of(p.0))
            .collect::<Vec<f64>>();
        let bytes: Vec<u8> = linear.iter().flat_map(|v| (*v as f32).to_le_bytes()).collect();
        std::fs::write(bench.at(&format!("ready/{}.f32", frame.name)), bytes).unwrap();
    }
    let mut command = program();
    command
        .env("SCALEPROOF_PYTHON", bench.at("python"))
        .env("SCALEPROOF_HOME", bench.folder.path())
        .env("SCALEPROOF_SHARED", shared(""));
    let fixed = "attack evaluate --length-mm 455 --material Material.001 --field-of-view-deg 50 --normal 808080 --light studio --azimuth-deg 45 200 \
                 --pitch-deg 15 --distance-mm 560 --size-px 96x64 --tile-mm 480 --detector yolox_nano --pattern";
    command.args(fixed.split_whitespace());
    command.arg(format!("random7={}", set.folder.join("patterns/random7.png").display()));
    command.arg("--mesh").arg(mesh).arg("-o").arg(bench.at("out"));
    let output = command.arg("--cache").arg(bench.at("cache")).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    println!("{}", stdout(&output));

    let session = Session::open(&bench.at("out/session")).unwrap();
    assert_eq!(session.photos.len(), 4);
    for photo in &session.photos {
        let paint = if photo.variant == "normal" { "808080" } else { "random7" };
        let view = photo.viewpoint.unwrap();
        let name = format!("studio@0_az{}_p15_d560_{paint}", view.azimuth_deg);
        let frame = set.list.frames.iter().find(|f| f.name == name).unwrap();
        let picture = image::open(session.photo_path(photo)).unwrap().into_rgb8();
        assert!(picture == set.rgb(frame).unwrap(), "{name} is another picture");
        let object = set.object_mask(frame).unwrap();
        let covered: Vec<(u32, u32)> = object
            .enumerate_pixels()
            .filter(|p| p.2.0[0] >= 128)
            .map(|p| (p.0, p.1))
            .collect();
        let xs = || covered.iter().map(|p| f64::from(p.0));
        let ys = || covered.iter().map(|p| f64::from(p.1));
        let truth = photo.box_xyxy_px.unwrap();
        let off = [
            xs().fold(f64::MAX, f64::min) - truth.x1,
            ys().fold(f64::MAX, f64::min) - truth.y1,
            xs().fold(0.0, f64::max) + 1.0 - truth.x2,
            ys().fold(0.0, f64::max) + 1.0 - truth.y2,
        ];
        // A pixel that is covered by half or more is at most half a pixel beyond the edge.
        assert!(off.iter().all(|px| px.abs() < 0.75), "{name}: {off:?}");
    }
}

/// What of a page is out of sight in a window of this width: how much of which table, and of the page.
fn out_of_sight(page: &Path, width: u32) -> String {
    let tell = "<script>addEventListener('load', () => { const out = e => e.scrollWidth - e.clientWidth; \
        const wide = [document.body, ...document.querySelectorAll('.scroll')].filter(out); \
        document.title = wide.map(e => out(e) + ' px: ' + e.textContent.slice(0, 40)).join('; '); })</script></body>";
    let text = std::fs::read_to_string(page).unwrap().replace("</body>", tell);
    let telling = page.with_file_name("telling.html");
    std::fs::write(&telling, text).unwrap();
    let output = common::chromium(&[
        format!("--window-size={width},900"),
        "--dump-dom".to_owned(),
        format!("file://{}", telling.display()),
    ]);
    let page = String::from_utf8(output.stdout).unwrap();
    page.split("<title>")
        .nth(1)
        .unwrap()
        .split('<')
        .next()
        .unwrap()
        .to_owned()
}

/// A dozen detectors and four patterns, whose names are as long as people's.
#[test]
fn a_laptop_shows_the_page_without_scrolling_sideways() {
    let bench = Bench::new(seen_px(400.0));
    let mut more = Vec::new();
    for i in 0..10 {
        let file = format!("detector_{i}.toml");
        let manifest = std::fs::read_to_string(bench.at("made.toml")).unwrap();
        let manifest = manifest.replace("\"made\"", &format!("\"detector_{i}\""));
        std::fs::write(
            bench.at(&file),
            manifest.replace("The made", &format!("Detector-Large v{i} 640")),
        )
        .unwrap();
        more.extend(["--detector".to_owned(), bench.at(&file).display().to_string()]);
    }
    more.push("--pattern".to_owned());
    more.extend(["optimised_640", "optimised_1280"].map(|name| format!("{name}={}", bench.at("p1.png").display())));
    let more: Vec<&str> = more.iter().map(String::as_str).collect();
    let output = bench.run(&more);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(out_of_sight(&bench.at("out/evaluation.html"), 1280), "");
    assert_eq!(out_of_sight(&bench.at("out/score/report.html"), 1280), "");
    // The page is as wide as the window: it is not that nothing was measured.
    assert!(out_of_sight(&bench.at("out/evaluation.html"), 400).contains(" px: "));
}
