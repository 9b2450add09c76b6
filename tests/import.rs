//! Sessions made of truth from elsewhere: COCO annotations and tables become a session that scores without tags and camera.

use crate::common;

use common::{assert_refused, program, read_json, skyline, stderr, stdout};
use scaleproof_session::Session;
use std::path::Path;
use std::process::Output;

/// The scene of a simulator: no tags.
const SCENE: &str = "[model]\nname = \"car\"\nscale = 10\nclass = \"car\"\nsize_mm = [455.0, 185.7, 129.1]\n\
    [bins]\nazimuth_deg = 45\npitch_deg = [15]\ndistance_mm = [850]\n";

const HEADER: &str = "file,variant,place,x1,y1,x2,y2,azimuth_deg,pitch_deg,distance_mm\n";

/// The photos of the stored session and what was detected in them, with a scene without tags, no camera, and no session.json.
fn photos() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("recorded")).unwrap();
    for below in ["", "recorded"] {
        for entry in std::fs::read_dir(skyline().join(below)).unwrap() {
            let path = entry.unwrap().path();
            let is_wanted = below == "recorded" || path.extension().is_some_and(|e| e == "jpg");
            if is_wanted {
                let copy = folder.path().join(below).join(path.file_name().unwrap());
                std::fs::copy(&path, copy).unwrap();
            }
        }
    }
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    folder
}

fn import(file: &Path, photos: &Path, more: &[&str]) -> Output {
    let mut command = program();
    command
        .args(["session", "import"])
        .arg(file)
        .arg("--photos")
        .arg(photos);
    command.args(more).output().unwrap()
}

fn score(session: &Path, out: &Path) -> Output {
    let mut command = program();
    command
        .arg("score")
        .arg(session)
        .args(["--recorded", "--all", "--out"])
        .arg(out);
    command.output().unwrap()
}

/// The exact truth of the stored session as a table.
fn exact_table() -> String {
    let truth = read_json(&skyline().join("truth.json"));
    let line = |photo: &serde_json::Value| {
        let file = photo["file"].as_str().unwrap();
        let corners: Vec<String> = photo["box_xyxy_px"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| v.to_string())
            .collect();
        let variant = file.split('_').next().unwrap();
        let [a, p, d] = ["azimuth_deg", "pitch_deg", "distance_mm"].map(|key| &photo[key]);
        format!("{file},{variant},yard,{},{a},{p},{d}\n", corners.join(","))
    };
    HEADER.to_owned() + &truth["photos"].as_array().unwrap().iter().map(line).collect::<String>()
}

#[test]
fn a_table_becomes_a_session_that_scores_without_tags_and_camera() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let table = out.path().join("truth.csv");
    std::fs::write(&table, exact_table()).unwrap();
    let before = std::fs::read(folder.path().join("normal_000.jpg")).unwrap();
    let output = import(&table, folder.path(), &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("16 photos (normal 8, random 8)"),
        "{}",
        stdout(&output)
    );
    assert_eq!(std::fs::read(folder.path().join("normal_000.jpg")).unwrap(), before);

    let output = score(folder.path(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("truth boxes: 16 given by the session\n"),
        "{}",
        stdout(&output)
    );
    let summary = read_json(&out.path().join("summary.json"));
    assert_eq!(summary["photos_scored"], 16);
    // The truth boxes are the table's, the bins those of its viewpoints.
    let coco = read_json(&out.path().join("coco_truth.json"));
    let exact = read_json(&skyline().join("truth.json"));
    let rows = std::fs::read_to_string(out.path().join("photos.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(rows.as_bytes());
    let header = rows.headers().unwrap().clone();
    let of = |row: &csv::StringRecord, name: &str| row[header.iter().position(|h| h == name).unwrap()].to_owned();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    for (i, truth) in exact["photos"].as_array().unwrap().iter().enumerate() {
        let found: [f64; 4] = serde_json::from_value(coco["annotations"][i]["bbox"].clone()).unwrap();
        let wanted: [f64; 4] = serde_json::from_value(truth["box_xyxy_px"].clone()).unwrap();
        assert!((found[0] - wanted[0]).abs() < 1e-9 && (found[0] + found[2] - wanted[2]).abs() < 1e-9);
        let row = rows
            .iter()
            .find(|row| of(row, "file") == truth["file"].as_str().unwrap())
            .unwrap();
        let bin: f64 = of(row, "bin_azimuth_deg").parse().unwrap();
        assert_eq!(bin, truth["bin_azimuth_deg"].as_f64().unwrap());
        assert_eq!(of(row, "truth_source"), "session");
    }
    // Beside photos whose truth boxes are drawn around the model's box, a caution is due. The same photos count once, so that only half are imported.
    let half = photos();
    let lines = exact_table();
    let normal: Vec<&str> = lines.lines().filter(|line| !line.starts_with("random")).collect();
    std::fs::write(&table, normal.join("\n") + "\n").unwrap();
    assert!(import(&table, half.path(), &[]).status.success());
    let mut command = program();
    command
        .arg("score")
        .arg(half.path())
        .arg(skyline())
        .args(["--recorded", "--detector", "fastestdet", "--out"]);
    let output = command.arg(out.path()).output().unwrap();
    assert!(
        stderr(&output).contains("truth boxes of several kinds are pooled in every figure (box, given by the session)"),
        "{}",
        stderr(&output)
    );
    // A second import does not replace the session.
    assert_refused(&import(&table, folder.path(), &[]), &["session.json is there already"]);
}

/// Boxes without viewpoints, of photos that show tags: scene and camera lie elsewhere, and the tags give the viewpoints.
#[test]
fn tags_give_the_viewpoints_that_a_table_lacks() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let table = out.path().join("boxes.csv");
    let text = "x1,y1,x2,y2,file,variant\n471.7,336.4,761.4,634.3,normal_000.jpg,normal\n332.6,347.3,896.6,656.5,normal_001.jpg,normal\n";
    std::fs::write(&table, text).unwrap();
    let [scene, camera] = ["scene.toml", "camera.yaml"].map(|name| skyline().join(name).display().to_string());
    let output = import(&table, folder.path(), &["--scene", &scene, "--camera", &camera]);
    assert!(output.status.success(), "{}", stderr(&output));
    let output = score(folder.path(), out.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let coco = read_json(&out.path().join("coco_truth.json"));
    let exact = read_json(&skyline().join("truth.json"));
    for i in 0..2 {
        let found = coco["images"][i]["azimuth_deg"].as_f64().unwrap();
        assert!((found - exact["photos"][i]["azimuth_deg"].as_f64().unwrap()).abs() < 0.1);
    }
    assert_eq!(coco["annotations"][0]["bbox"][0], 471.7);
}

/// What `score` writes as COCO truth is read back as the same truth, and scores the same.
#[test]
fn our_own_coco_truth_goes_round() {
    let (folder, first, second) = (photos(), tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    assert!(score(&skyline(), first.path()).status.success());
    let output = import(&first.path().join("coco_truth.json"), folder.path(), &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    let session = Session::open(folder.path()).unwrap();
    assert!(session.camera.is_none() && session.photos.iter().all(|p| p.place.as_deref() == Some("yard")));
    let output = score(folder.path(), second.path());
    assert!(output.status.success(), "{}", stderr(&output));
    let results = [first.path(), second.path()].map(|out| read_json(&out.join("summary.json"))["results"].clone());
    assert_eq!(results[0], results[1]);
    let [a, b] = [first.path(), second.path()].map(|out| read_json(&out.join("coco_truth.json")));
    for i in 0..16 {
        let bbox = |coco: &serde_json::Value| -> [f64; 4] {
            serde_json::from_value(coco["annotations"][i]["bbox"].clone()).unwrap()
        };
        let pairs = bbox(&a).into_iter().zip(bbox(&b));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9));
        for key in [
            "file_name",
            "variant",
            "place",
            "azimuth_deg",
            "pitch_deg",
            "distance_mm",
        ] {
            assert!(!a["images"][i][key].is_null(), "{key}");
            assert_eq!(a["images"][i][key], b["images"][i][key], "{key}");
        }
    }
}

/// A simulator's export: attributes on the annotation, other categories, a frame without the model, one texture for all.
#[test]
fn a_foreign_coco_file_is_read() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let file = out.path().join("export.json");
    let text = r#"{"info": {}, "licenses": [],
        "images": [{"id": 10, "file_name": "normal_000.jpg", "width": 1280, "height": 960, "date_captured": "x"},
                   {"id": 11, "file_name": "normal_001.jpg"}, {"id": 12, "file_name": "normal_002.jpg"}],
        "annotations": [
            {"id": 1, "image_id": 10, "category_id": 3, "bbox": [470, 330, 290, 300], "segmentation": [],
             "attributes": {"occluded": false, "place": "town 3", "azimuth_deg": 3, "pitch_deg": 15, "distance_mm": 885}},
            {"id": 2, "image_id": 10, "category_id": 1, "bbox": [0, 0, 30, 30]},
            {"id": 3, "image_id": 11, "category_id": 3, "bbox": [330, 340, 570, 310],
             "attributes": {"azimuth_deg": 45, "pitch_deg": 17, "distance_mm": 851}}],
        "categories": [{"id": 1, "name": "person"}, {"id": 3, "name": "car"}]}"#;
    std::fs::write(&file, text).unwrap();
    let output = import(&file, folder.path(), &["--variant", "normal"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("1 photo has no box of the model") && stderr(&output).contains("normal_002.jpg"));
    let session = Session::open(folder.path()).unwrap();
    assert_eq!(session.photos.len(), 2);
    assert_eq!(
        session.photos[0].box_xyxy_px.map(<[f64; 4]>::from),
        Some([470.0, 330.0, 760.0, 630.0])
    );
    assert_eq!(session.photos[0].place.as_deref(), Some("town 3"));
    assert_eq!(session.photos[1].viewpoint.unwrap().azimuth_deg, 45.0);
    assert!(score(folder.path(), out.path()).status.success());
}

#[test]
fn bad_tables_are_one_sentence() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let file = out.path().join("truth.csv");
    let good = "normal_000.jpg,normal,yard,470,330,760,630,3,15,885";
    for (text, words) in [
        (String::new(), vec!["truth.csv, line 1", "no column file"]),
        ("file;x1;y1\n".into(), vec!["line 1", "is no column this program reads"]),
        ("file,x1,y1,x2,y2,x1\n".into(), vec!["line 1", "x1 is there twice"]),
        ("file,variant,x1,y1,x2\n".into(), vec!["line 1", "no column y2"]),
        (HEADER.into(), vec!["truth.csv: it has no photo"]),
        (
            format!("{HEADER}{good}\n{good},1\n"),
            vec!["line 3", "11 values where the header has 10"],
        ),
        (
            format!("{HEADER}{good}\n\n{good}\n"),
            vec!["line 4", "normal_000.jpg is listed twice"],
        ),
        (
            HEADER.to_owned() + &good.replace("470", "left"),
            vec!["line 2", "x1 is `left`"],
        ),
        (
            HEADER.to_owned() + &good.replace("470", "nan"),
            vec!["line 2", "x1 is `nan`"],
        ),
        (
            HEADER.to_owned() + &good.replace("470", ""),
            vec!["line 2", "x1 is empty"],
        ),
        (
            HEADER.to_owned() + &good.replace("470", "770"),
            vec!["line 2", "box_xyxy_px of normal_000.jpg is empty"],
        ),
        (
            HEADER.to_owned() + &good.replace("470,330,760,630", "1470,330,1760,630"),
            vec!["line 2", "outside its 1280×960 px"],
        ),
        (
            HEADER.to_owned() + &good.replace("470,330,760,630", "470,330,1520,630"),
            vec!["line 2", "reaches out of its 1280×960 px"],
        ),
        (
            HEADER.to_owned() + &good.replace("470,330,760,630", "470,330,760,1e308"),
            vec!["line 2", "reaches out of its 1280×960 px"],
        ),
        (
            HEADER.to_owned() + &good.replace(",15,", ",,"),
            vec!["line 2", "give all or none"],
        ),
        (
            HEADER.to_owned() + &good.replace(",3,15", ",363,15"),
            vec!["line 2", "azimuth_deg is in [0, 360)"],
        ),
        (
            HEADER.to_owned() + &good.replace(",3,15,885", ",,,"),
            vec!["names no camera", "normal_000.jpg has not both"],
        ),
        (
            HEADER.to_owned() + &good.replace(",normal,", ",,"),
            vec!["line 2", "give --variant"],
        ),
        (
            HEADER.to_owned() + &good.replace("normal_000", "normal_999"),
            vec!["line 2", "normal_999.jpg"],
        ),
        (
            HEADER.to_owned() + &good.replace("normal_000.jpg", "../a.jpg"),
            vec!["line 2", "not a path below"],
        ),
        (
            HEADER.to_owned() + &good.replace("normal_000.jpg", "scene.toml"),
            vec!["line 2", "is not a JPEG or PNG"],
        ),
    ] {
        std::fs::write(&file, &text).unwrap();
        let output = import(&file, folder.path(), &[]);
        println!("{}", stderr(&output).trim_end());
        assert_refused(&output, &words);
        assert!(!folder.path().join("session.json").exists(), "nothing is written");
    }
    assert_refused(
        &import(&folder.path().join("scene.toml"), folder.path(), &[]),
        &["neither a COCO"],
    );
    assert_refused(
        &import(&out.path().join("gone.csv"), folder.path(), &[]),
        &["cannot read", "gone.csv"],
    );
    std::fs::remove_file(folder.path().join("scene.toml")).unwrap();
    assert_refused(&import(&file, folder.path(), &[]), &["cannot read", "scene.toml"]);
}

#[test]
fn bad_annotations_are_one_sentence() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let file = out.path().join("truth.json");
    let image = r#"{"id":1,"file_name":"normal_000.jpg","width":1280,"height":960,"variant":"normal","azimuth_deg":3,"pitch_deg":15,"distance_mm":885}"#;
    let annotation = r#"{"id":1,"image_id":1,"category_id":3,"bbox":[470,330,290,300]}"#;
    let text = |images: &str, annotations: &str| {
        format!(
            "{{\"images\":[{images}],\n\"annotations\":[{annotations}],\n\"categories\":[{{\"id\":3,\"name\":\"car\"}}]}}"
        )
    };
    let good = text(image, annotation);
    for (text, words) in [
        ("{".to_owned(), vec!["truth.json, line 1", "EOF"]),
        (
            "[]".to_owned(),
            vec!["truth.json, line 1", "the keys of COCO annotations"],
        ),
        (
            good.replace("\"car\"", "\"cat\""),
            vec!["no category `car`", "it has `cat`"],
        ),
        (
            good.replace("\"bbox\"", "\"box\""),
            vec!["line 2", "missing field `bbox`"],
        ),
        (
            good.replace("290,300", "290,-300"),
            vec!["image 1", "width and height above 0"],
        ),
        (
            good.replace("290,300", "290"),
            vec!["line 2", "expected an array of length 4"],
        ),
        (
            text(image, &format!("{annotation},{annotation}")),
            vec!["image 1", "2 boxes of `car`"],
        ),
        (
            text(&format!("{image},{image}"), annotation),
            vec!["image 1", "its id appears twice"],
        ),
        (text(image, ""), vec!["no photo with a box of `car`"]),
        (
            good.replace("\"image_id\":1", "\"image_id\":7"),
            vec!["image 7, which is not in `images`"],
        ),
        (
            good.replace("1280", "640"),
            vec!["image 1", "1280×960 px upright and not 640×960"],
        ),
        (
            good.replace("\"variant\":\"normal\",", ""),
            vec!["image 1", "give --variant"],
        ),
        (
            good.replace("\"pitch_deg\":15,", ""),
            vec!["image 1", "give all or none"],
        ),
    ] {
        std::fs::write(&file, &text).unwrap();
        let output = import(&file, folder.path(), &[]);
        println!("{}", stderr(&output).trim_end());
        assert_refused(&output, &words);
        assert!(!folder.path().join("session.json").exists(), "nothing is written");
    }
    std::fs::write(&file, &good).unwrap();
    assert!(import(&file, folder.path(), &[]).status.success());
}

/// Commands that locate photos say that such a session has no camera.
#[test]
fn a_session_without_a_camera_cannot_be_charted() {
    let (folder, out) = (photos(), tempfile::tempdir().unwrap());
    let table = out.path().join("truth.csv");
    std::fs::write(&table, exact_table()).unwrap();
    assert!(import(&table, folder.path(), &[]).status.success());
    let mut command = program();
    command.args(["chart", "envelope", "--session"]).arg(folder.path());
    command
        .arg("--truth")
        .arg(skyline().join("truth.json"))
        .arg("-o")
        .arg(out.path());
    assert_refused(&command.output().unwrap(), &["this session names no camera"]);
}
