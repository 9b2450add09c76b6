//! Files as other people's programs write them, through the program: photos, cards, boxes and numbers. A new file is a new line of a table.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, program, read_json, run, skyline, stderr, stdout, text, write};
use image::{DynamicImage, RgbImage};
use scaleproof_pose::scene::Scene;
use serde_json::{Value, json};

/// `locate --json` of photos, by a scene of one's own or the stored one.
fn located(photos: &[PathBuf], scene: &Path) -> (Output, Vec<Value>) {
    let mut command = program();
    command
        .args(["locate", "--json"])
        .args(photos)
        .arg("--scene")
        .arg(scene);
    let output = command
        .arg("--camera")
        .arg(skyline().join("camera.yaml"))
        .output()
        .unwrap();
    let lines = stdout(&output)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    (output, lines)
}

/// The segments of a JPEG up to its first scan are kept where `keep` says so, by their markers.
fn with_segments(jpeg: &[u8], keep: impl Fn(u8) -> bool) -> Vec<u8> {
    let (mut kept, mut at) = (jpeg[..2].to_vec(), 2);
    while jpeg[at + 1] != 0xDA {
        let end = at + 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        if keep(jpeg[at + 1]) {
            kept.extend_from_slice(&jpeg[at..end]);
        }
        at = end;
    }
    [&kept, &jpeg[at..]].concat()
}

/// An image of motion JPEG, and one whose last two bytes were lost: libjpeg reads both without loss.
#[test]
fn jpegs_without_tables_or_without_their_end_are_located_as_the_whole_ones() {
    let folder = tempfile::tempdir().unwrap();
    let base = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    // The standard's tables are those of an encoder that computes none.
    let picture = image::open(skyline().join("normal_000.jpg")).unwrap().into_rgb8();
    let plain = scaleproof_photo::preview_jpeg(&picture, 92).unwrap();
    let (stored, bare) = (
        write(folder.path(), "plain.jpg", &plain),
        with_segments(&plain, |marker| marker != 0xC4),
    );
    assert!(bare.len() < plain.len() - 400);
    let (bare, endless) = (
        write(folder.path(), "avi1.jpg", bare),
        write(folder.path(), "noeoi.jpg", &base[..base.len() - 2]),
    );
    let photos = [skyline().join("normal_000.jpg"), endless, stored, bare];
    let (output, lines) = located(&photos, &skyline().join("scene.toml"));
    assert!(output.status.success(), "{}", stderr(&output));
    for line in &lines {
        let near = |key: &str, value: f64, within: f64| {
            assert!((line[key].as_f64().unwrap() - value).abs() < within, "{line}");
        };
        near("azimuth_deg", 2.83, 0.01);
        near("pitch_deg", 15.09, 0.01);
        near("distance_mm", 884.8, 0.3);
    }
    for (same, [a, b]) in ["distance_mm", "rms_px"]
        .into_iter()
        .flat_map(|key| [[0, 1], [2, 3]].map(|pair| (key, pair)))
    {
        assert_eq!(lines[a][same], lines[b][same]);
    }
    assert_eq!(stderr(&output).matches("note: ").count(), 1, "{}", stderr(&output));
    assert!(stderr(&output).contains("noeoi.jpg has no end-of-image marker"));
    let cut = write(folder.path(), "cut.jpg", &base[..base.len() - 400]);
    let (output, _) = located(&[cut], &skyline().join("scene.toml"));
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("cut.jpg ends in the middle of the image"),
        "{}",
        stderr(&output)
    );
}

/// The stored scene as if it had been printed otherwise: what `[cards]` says of it is worked into each tag.
fn scene_with(cards: &str, folder: &Path) -> PathBuf {
    let stored = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    let with = format!("[cards]\n{cards}\n\n{stored}");
    let scene = Scene::parse(&with, Path::new("scene.toml")).unwrap();
    let model = scene.model.with_files(|path| skyline().join(path));
    let scene = Scene { model, ..scene };
    write(folder, "scene.toml", scene.to_toml())
}

/// The cause is said once, and the line that it names makes all photos good.
#[test]
fn cards_that_all_differ_in_one_way_are_said_once_with_the_line_that_says_so() {
    let photos: Vec<PathBuf> = (0..8).map(|i| skyline().join(format!("normal_00{i}.jpg"))).collect();
    let (_, truth) = located(&photos, &skyline().join("scene.toml"));
    for (scene_has, words, line) in [
        ("turned_deg = 180", "all tags are turned by 180°", "turned_deg = 180"),
        (
            "turned_deg = 90",
            "all tags are turned by 270° clockwise",
            "turned_deg = 270",
        ),
        (
            "turned_deg = 270",
            "all tags are turned by 90° clockwise",
            "turned_deg = 90",
        ),
        (
            "ids_higher_by = 100",
            "the ids of all tags are 100 lower",
            "ids_higher_by = -100",
        ),
        (
            "ids_higher_by = 3",
            "the ids of all tags are 3 lower",
            "ids_higher_by = -3",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene_with(scene_has, folder.path());
        let (output, _) = located(&photos, &scene);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{scene_has}: {said}");
        let notes: Vec<&str> = said.lines().filter(|line| line.starts_with("note: ")).collect();
        let [note] = notes[..] else {
            panic!("{scene_has}: {said}")
        };
        assert!(
            note.contains(words) && note.contains(&format!("`[cards]` and `{line}`")),
            "{note}"
        );
        assert!(note.contains("8 of the 8 photos"), "{note}");
        let righted = format!("[cards]\n{line}\n\n{}", std::fs::read_to_string(&scene).unwrap());
        std::fs::write(&scene, righted).unwrap();
        let (output, lines) = located(&photos, &scene);
        assert!(output.status.success(), "{}", stderr(&output));
        for (line, truth) in lines.iter().zip(&truth) {
            let [a, b] = [line, truth].map(|line| line["azimuth_deg"].as_f64().unwrap());
            assert!((a - b).abs() < 0.01, "{scene_has}: {a} {b}");
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let stored = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    for (cards, words) in [
        ("turned_deg = 45", "cards.turned_deg is 45: give 0, 90, 180 or 270"),
        (
            "ids_higher_by = -1",
            "cards.ids_higher_by is -1, and tag 0 has no such id",
        ),
        ("ids_higher_by = 9223372036854775807", "has no such id"),
        ("turned = 90", "unknown field"),
    ] {
        let scene = write(folder.path(), "scene.toml", format!("[cards]\n{cards}\n{stored}"));
        assert_refused(&located(&photos[..1], &scene).0, &[words]);
    }
}

#[test]
fn mirrored_prints_are_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let mirrored = |i: usize| {
        let picture = image::open(skyline().join(format!("normal_00{i}.jpg"))).unwrap();
        let mut bytes = Vec::new();
        let picture: RgbImage = DynamicImage::fliph(&picture).into_rgb8();
        let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95);
        picture.write_with_encoder(encoder).unwrap();
        write(folder.path(), &format!("{i}.jpg"), bytes)
    };
    let photos: Vec<PathBuf> = (0..5).map(mirrored).collect();
    let (output, _) = located(&photos, &skyline().join("scene.toml"));
    let said = stderr(&output);
    assert_eq!(said.matches("note: ").count(), 1, "{said}");
    assert!(said.contains("the tags are mirrored: 4 of 4 photos"), "{said}");
}

/// COCO images with the names of the stored photos and numbers that `id` makes; and their boxes.
fn coco(id: impl Fn(usize) -> Value, bbox: [f64; 4]) -> Value {
    let all = 0..8;
    let images = all.clone().map(|i| json!({"id": id(i), "file_name": format!("normal_00{i}.jpg"), "width": 1280.0, "height": 960, "variant": "normal", "place": "yard", "azimuth_deg": 2.8, "pitch_deg": 15.0, "distance_mm": 884.0}));
    let annotations = all.map(|i| json!({"image_id": id(i), "category_id": 3.0, "bbox": bbox, "iscrowd": 0.0}));
    json!({"images": images.collect::<Value>(), "annotations": annotations.collect::<Value>(), "categories": [{"id": 3, "name": "car"}]})
}

const IN_PX: [f64; 4] = [474.0, 331.0, 306.0, 315.0];
const IN_SHARES: [f64; 4] = [0.37, 0.34, 0.24, 0.33];

/// A folder with the stored photos and a scene without tags.
fn photos() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..8 {
        let name = format!("normal_00{i}.jpg");
        std::fs::copy(skyline().join(&name), folder.path().join(name)).unwrap();
    }
    write(
        folder.path(),
        "scene.toml",
        "[model]\nname = \"car\"\nscale = 10\nclass = \"car\"\nsize_mm = [455.0, 185.7, 129.1]\n\
         [bins]\nazimuth_deg = 45\npitch_deg = [15]\ndistance_mm = [850]\n",
    );
    folder
}

fn import(file: &Path, folder: &Path) -> Output {
    let scene = folder.join("scene.toml");
    run(&[
        "session",
        "import",
        text(file),
        "--photos",
        text(folder),
        "--scene",
        text(&scene),
    ])
}

/// Boxes of 0…1 would blame the detector: every door refuses them.
#[test]
fn boxes_in_shares_are_refused_at_every_door() {
    let folder = photos();
    let shares = "look like shares of the photo's width and height";
    let file = write(
        folder.path(),
        "coco.json",
        coco(|i| json!(i + 1), IN_SHARES).to_string(),
    );
    assert_refused(&import(&file, folder.path()), &["normal_000.jpg", shares]);
    let table = "file,variant,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm\nnormal_000.jpg,normal,0.37,0.34,0.61,0.67,2.8,15,884\n";
    let file = write(folder.path(), "table.csv", table);
    assert_refused(&import(&file, folder.path()), &["line 2", "normal_000.jpg", shares]);
    let photo = json!({"file": "normal_000.jpg", "variant": "normal", "box_xyxy_px": [0.37, 0.34, 0.61, 0.67], "viewpoint": {"azimuth_deg": 2.8, "pitch_deg": 15, "distance_mm": 884}});
    let session = json!({"scene": "scene.toml", "photos": [photo]});
    write(folder.path(), "session.json", session.to_string());
    let out = folder.path().join("out");
    assert_refused(
        &run(&["score", text(folder.path()), "--recorded", "-o", text(&out)]),
        &["session.json", "normal_000.jpg", shares],
    );
    let results = json!([{"image_id": "normal_000.jpg", "category_id": 3, "bbox": IN_SHARES, "score": 0.9}]);
    let results = write(folder.path(), "results.json", results.to_string());
    let given = format!("mine={}", results.display());
    assert_refused(
        &run(&["score", text(&skyline()), "--results", &given, "-o", text(&out)]),
        &["results.json", shares],
    );
}

/// pandas writes 1.0 for 1, in files of truth and of results.
#[test]
fn whole_numbers_with_a_point_are_read_and_fractions_refused_in_words() {
    let folder = photos();
    let with = |name: &str, id: fn(usize) -> Value| write(folder.path(), name, coco(id, IN_PX).to_string());
    let file = with("half.json", |i| json!(i as f64 + 1.5));
    assert_refused(&import(&file, folder.path()), &["1.5 is no whole number from 0 up"]);
    let file = with("negative.json", |i| json!(-(i as i64) - 1));
    assert_refused(&import(&file, folder.path()), &["-1 is no whole number from 0 up"]);
    let file = with("coco.json", |i| json!(i as f64 + 1.0));
    let output = import(&file, folder.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let results = |id: Value, category: Value| {
        let lines = json!([{"image_id": id, "category_id": category, "bbox": IN_PX, "score": 0.9}]);
        let file = write(folder.path(), "results.json", lines.to_string());
        let (given, out) = (format!("mine={}", file.display()), folder.path().join("out"));
        let images = folder.path().join("coco.json");
        let arguments = [
            "score",
            text(folder.path()),
            "--results",
            &given,
            "--images",
            text(&images),
            "-o",
            text(&out),
        ];
        (run(&arguments), out)
    };
    let (output, out) = results(json!(1.0), json!(3.0));
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("1/8"), "{}", stdout(&output));
    assert_eq!(
        read_json(&out.join("coco_truth.json"))["images"]
            .as_array()
            .unwrap()
            .len(),
        8
    );
    assert_refused(
        &results(json!(1.5), json!(3)).0,
        &["results.json, line 1", "a whole number from 0 up, or a name"],
    );
    assert_refused(&results(json!(1), json!(3.5)).0, &["3.5 is no whole number from 0 up"]);
}

/// A pattern that hides everything leaves files without a detection.
#[test]
fn results_without_any_detection_count_as_nothing_found() {
    let folder = photos();
    let coco = write(folder.path(), "coco.json", coco(|i| json!(i + 1), IN_PX).to_string());
    assert!(import(&coco, folder.path()).status.success());
    let empty = write(folder.path(), "empty.json", "[]");
    let labels = folder.path().join("labels");
    std::fs::create_dir(&labels).unwrap();
    (0..8).for_each(|i| drop(write(&labels, &format!("normal_00{i}.txt"), "")));
    for (path, more) in [(&empty, &["--images", text(&coco)][..]), (&labels, &[])] {
        let (given, out) = (format!("mine={}", path.display()), folder.path().join("out"));
        let arguments = ["score", text(folder.path()), "--results", &given, "-o", text(&out)];
        let output = run(&[&arguments, more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains("0/8"), "{}", stdout(&output));
        let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
        assert!(summary.contains("have no detection in any of 8 photos"), "{summary}");
        std::fs::remove_dir_all(&out).unwrap();
    }
    std::fs::remove_file(labels.join("normal_003.txt")).unwrap();
    for path in [&empty, &labels] {
        let (given, out) = (format!("mine={}", path.display()), folder.path().join("out"));
        assert_refused(
            &run(&["score", text(folder.path()), "--results", &given, "-o", text(&out)]),
            &["no detection in any photo of this run", "does not list them all"],
        );
    }
    // As `numpy.savetxt` writes it.
    write(
        &labels,
        "normal_003.txt",
        "2.000000000000000000e+00 4.9e-01 5.1e-01 2.4e-01 3.3e-01 6.334990000000000343e-01\n",
    );
    let (given, out) = (format!("mine={}", labels.display()), folder.path().join("out"));
    let output = run(&["score", text(folder.path()), "--results", &given, "-o", text(&out)]);
    assert!(
        stdout(&output).contains("1/8"),
        "{}{}",
        stdout(&output),
        stderr(&output)
    );
    write(&labels, "normal_003.txt", "2.5 0.49 0.51 0.24 0.33 0.6\n");
    assert_refused(
        &run(&["score", text(folder.path()), "--results", &given, "-o", text(&out)]),
        &["normal_003.txt, line 1", "the class \"2.5\" is no whole number"],
    );
}

/// Views that OpenCV drew of a board in its layout before 4.6 (`tests/data/make_legacy_board.py`), by a focal length of 700 px. With the newer layout
/// in the board's file, each corner still lies between the two markers that are named for it, or all lie one square further.
#[test]
fn boards_of_opencvs_old_layout_are_calibrated() {
    let folder = tempfile::tempdir().unwrap();
    let stored = common::home().join("tests/data/cases/legacy_board");
    let photos: Vec<PathBuf> = (0..6).map(|i| stored.join(format!("{i}.jpg"))).collect();
    let legacy = std::fs::read_to_string(stored.join("board.toml")).unwrap();
    for text in [
        legacy.clone(),
        legacy.replace("legacy_layout = true", "legacy_layout = false"),
    ] {
        let (board, out) = (
            write(folder.path(), "board.toml", text),
            folder.path().join("camera.yaml"),
        );
        let mut command = program();
        command
            .arg("calibrate")
            .arg("--board")
            .arg(board)
            .args(&photos)
            .arg("-o")
            .arg(&out);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(
            stdout(&output).matches(".jpg                             35 ").count(),
            6,
            "{}",
            stdout(&output)
        );
        let camera = scaleproof_pose::camera::Camera::open(&out).unwrap();
        assert!((camera.fx / 700.0 - 1.0).abs() < 0.005, "{camera:?}");
    }
}

/// A pattern as an attack in PyTorch keeps it: planes of red, green and blue; and as OpenCV's users do; in NumPy's format.
#[test]
fn patterns_that_numpy_saved_are_imported_cell_by_cell() {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = (0..48).map(|i| (i * 5) as u8).collect();
    let header = |shape: &str| {
        let text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({shape}), }}");
        [&b"\x93NUMPY\x01\0v\0"[..], format!("{text:<117}\n").as_bytes()].concat()
    };
    // 4 × 4 pixels of three planes, or of three values.
    let at = |x: usize, y: usize, channel: usize, is_planes: bool| {
        bytes[if is_planes {
            16 * channel + 4 * y + x
        } else {
            12 * y + 3 * x + channel
        }]
    };
    for (shape, is_planes) in [("3, 4, 4", true), ("1, 3, 4, 4", true), ("4, 4, 3", false)] {
        let array = write(folder.path(), "pattern.npy", [&header(shape)[..], &bytes].concat());
        let out = folder.path().join(format!("{}.png", shape.replace(", ", "_")));
        let output = run(&["pattern", "import", text(&array), "-o", text(&out)]);
        assert!(output.status.success(), "{}", stderr(&output));
        let cells = image::open(&out).unwrap().into_rgb8();
        for (x, y, pixel) in cells.enumerate_pixels() {
            let expected = [0, 1, 2].map(|channel| at(x as usize, y as usize, channel, is_planes));
            assert_eq!(pixel.0, expected, "{shape} {x} {y}");
        }
    }
    for (shape, words) in [
        ("3, 16, 3", "its shape is [3, 16, 3]"),
        ("48,", "its shape is [48]"),
        ("3, 4, 5", "it ends too early"),
    ] {
        let array = write(folder.path(), "pattern.npy", [&header(shape)[..], &bytes].concat());
        let out = folder.path().join("none.png");
        assert_refused(
            &run(&["pattern", "import", text(&array), "-o", text(&out)]),
            &["pattern.npy", words],
        );
    }
}
