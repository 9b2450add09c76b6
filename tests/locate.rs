//! `locate` on the stored session, against the session's exact truth, and on bad input.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, program, read_json, skyline, stderr, stdout, stored, write};
use scaleproof_core::geometry::angle::turn;

fn locate(photos: &[PathBuf], scene: &Path, camera: &Path, more: &[&str]) -> Output {
    program()
        .arg("locate")
        .args(photos)
        .arg("--scene")
        .arg(scene)
        .arg("--camera")
        .arg(camera)
        .args(more)
        .output()
        .unwrap()
}

fn locate_skyline(photos: &[PathBuf]) -> Output {
    locate(
        photos,
        &skyline().join("scene.toml"),
        &skyline().join("camera.yaml"),
        &["--json"],
    )
}

fn lines(output: &Output) -> Vec<serde_json::Value> {
    stdout(output)
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect()
}

#[test]
fn every_photo_of_the_session_is_where_the_truth_says() {
    assert_located(&stored(), 24);
    let worst = assert_located(&skyline(), 16);
    println!(
        "worst of 16: azimuth {:.4}°, pitch {:.4}°, distance {:.2} mm",
        worst[0], worst[1], worst[2]
    );
}

/// Checks the photos of a session against its truth; returns the largest errors of azimuth (°), pitch (°) and distance (mm).
fn assert_located(session: &Path, count: usize) -> [f64; 3] {
    let truth = read_json(&session.join("truth.json"));
    let truth = truth["photos"].as_array().unwrap();
    assert_eq!(truth.len(), count);
    let photos: Vec<PathBuf> = truth
        .iter()
        .map(|t| session.join(t["file"].as_str().unwrap()))
        .collect();
    let output = locate_skyline(&photos);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut worst = [0.0_f64; 3];
    for (found, truth) in lines(&output).iter().zip(truth) {
        let file = truth["file"].as_str().unwrap();
        let (f, t) = (
            |k: &str| found[k].as_f64().unwrap(),
            |k: &str| truth[k].as_f64().unwrap(),
        );
        assert_eq!(found["status"], "located", "{file}");
        let azimuth = turn(f("azimuth_deg"), t("azimuth_deg")).abs();
        let (pitch, distance) = (f("pitch_deg") - t("pitch_deg"), f("distance_mm") - t("distance_mm"));
        assert!(
            azimuth < 0.1 && pitch.abs() < 0.1,
            "{file}: off by {azimuth}° azimuth, {pitch}° pitch"
        );
        assert!(distance.abs() < 2.0, "{file}: off by {distance} mm");
        worst = [
            worst[0].max(azimuth),
            worst[1].max(pitch.abs()),
            worst[2].max(distance.abs()),
        ];
        assert_eq!(
            found["bin"]["azimuth_deg"].as_f64(),
            truth["bin_azimuth_deg"].as_f64(),
            "{file}"
        );
        for row in 0..3 {
            for column in 0..4 {
                let of = |m: &serde_json::Value| m[row][column].as_f64().unwrap();
                let off = (of(&found["T_camera_model"]) - of(&truth["T_camera_model_mm"])).abs();
                assert!(
                    off < if column == 3 { 1.0 } else { 0.002 },
                    "{file}: T[{row}][{column}] off by {off}"
                );
            }
        }
    }
    worst
}

#[test]
fn a_crop_that_looks_like_a_smaller_photo_is_refused_or_warned_of() {
    let whole = skyline().join("normal_000.jpg");
    let folder = tempfile::tempdir().unwrap();
    // The same aspect ratio as the camera's, so that the size gives nothing away.
    let mut photos = vec![whole.clone()];
    for (name, left, top, side) in [("middle", 32, 24, 19), ("corner", 0, 0, 17), ("aside", 0, 48, 19)] {
        let crop = folder.path().join(format!("{name}.png"));
        let cut = image::open(&whole).unwrap().crop_imm(left, top, 64 * side, 48 * side);
        cut.save(&crop).unwrap();
        photos.push(crop);
    }
    let found = lines(&locate_skyline(&photos));
    assert_eq!(found[0]["warnings"], serde_json::json!([]));
    let mut refused = 0;
    for crop in &found[1..] {
        let warned = crop["warnings"].as_array().unwrap().contains(&"poor_fit".into());
        let is_refused = crop["code"] == "high_residual";
        assert!(warned || is_refused, "{crop}");
        refused += usize::from(is_refused);
    }
    assert!(refused >= 2, "{refused} of 3");
}

#[test]
fn a_photo_without_tags_is_answered_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    // All tags painted over by a tiled floor as sharp as they were, the size kept, so that only the tags can be the reason.
    let mut photo = image::open(skyline().join("normal_002.jpg")).unwrap().to_rgb8();
    for (x, y, pixel) in photo.enumerate_pixels_mut() {
        if y > 300 {
            *pixel = image::Rgb([if (x / 60 + y / 60) % 2 == 0 { 90 } else { 160 }; 3]);
        }
    }
    let path = folder.path().join("bare.png");
    photo.save(&path).unwrap();
    let output = locate_skyline(std::slice::from_ref(&path));
    assert_refused(&output, &["bare.png", "no tag is visible"]);
    assert_eq!(lines(&output)[0]["code"], "no_tags");
    assert_eq!(lines(&output)[0]["status"], "abstained");
    assert!(lines(&output)[0]["azimuth_deg"].is_null());
    // Cropped away instead: the image has no longer the size the camera was calibrated for.
    image::imageops::crop_imm(&photo, 400, 0, 300, 300)
        .to_image()
        .save(&path)
        .unwrap();
    assert_refused(&locate_skyline(&[path]), &["300×300", "1280×960"]);
}

#[test]
fn files_that_are_no_photos_are_one_sentence_each() {
    let folder = tempfile::tempdir().unwrap();
    let photo = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    let cut = write(folder.path(), "cut.jpg", &photo[..photo.len() / 2]);
    assert_refused(&locate_skyline(&[cut]), &["cut.jpg", "ends in the middle"]);
    let text = write(folder.path(), "text.jpg", b"this is not a photo");
    assert_refused(&locate_skyline(&[text]), &["text.jpg", "not a JPEG or PNG"]);
    let empty = write(folder.path(), "empty.jpg", b"");
    assert_refused(&locate_skyline(&[empty]), &["empty.jpg", "not a JPEG or PNG"]);
    assert_refused(
        &locate_skyline(&[folder.path().join("none.jpg")]),
        &["cannot read", "none.jpg", "no such file"],
    );
}

#[test]
fn a_bad_photo_in_a_set_leaves_the_others_their_answer() {
    let folder = tempfile::tempdir().unwrap();
    let text = write(folder.path(), "text.jpg", b"this is not a photo");
    let output = locate_skyline(&[skyline().join("normal_000.jpg"), text, skyline().join("normal_001.jpg")]);
    assert_refused(&output, &["text.jpg", "not a JPEG or PNG"]);
    let status: Vec<_> = lines(&output)
        .iter()
        .map(|l| l["status"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(status, ["located", "abstained", "located"]);
}

#[test]
fn bad_scene_and_camera_files_are_one_sentence_each() {
    let folder = tempfile::tempdir().unwrap();
    let photo = [skyline().join("normal_000.jpg")];
    let (scene, camera) = (skyline().join("scene.toml"), skyline().join("camera.yaml"));
    let missing = folder.path().join("no_camera.yaml");
    assert_refused(
        &locate(&photo, &scene, &missing, &[]),
        &["cannot read", "no_camera.yaml"],
    );
    let text = std::fs::read_to_string(&scene).unwrap();
    let unknown = write(
        folder.path(),
        "unknown.toml",
        text.replace("scale = 10", "scale = 10\nwheels = 4").as_bytes(),
    );
    assert_refused(
        &locate(&photo, &unknown, &camera, &[]),
        &["unknown.toml, line 4", "unknown field `wheels`"],
    );
    let doubled = write(
        folder.path(),
        "doubled.toml",
        text.replace("id = 7\n", "id = 6\n").as_bytes(),
    );
    assert_refused(
        &locate(&photo, &doubled, &camera, &[]),
        &["doubled.toml", "tag id 6 appears twice"],
    );
    assert_refused(&locate(&photo, &camera, &camera, &[]), &["camera.yaml, line 1"]);
    assert_refused(
        &locate(&photo, &scene, &scene, &[]),
        &["scene.toml", "not a camera file"],
    );
}

/// The stored scene with one of its tags moved by 30 mm along y.
fn scene_with_moved_tag(folder: &Path) -> PathBuf {
    let text = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    let moved = text.replace(
        "centre_mm = [-153.073, 314.119, 0.800]",
        "centre_mm = [-153.073, 344.119, 0.800]",
    );
    assert_ne!(text, moved);
    write(folder, "scene.toml", moved.as_bytes())
}

#[test]
fn a_moved_card_is_named_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene_with_moved_tag(folder.path());
    let photo = [skyline().join("normal_002.jpg")];
    let output = locate(&photo, &scene, &skyline().join("camera.yaml"), &["--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("tag 2 is not where the scene has it"),
        "{}",
        stderr(&output)
    );
    let with = &lines(&output)[0];
    let ignored = with["ignored_tags"].as_array().unwrap();
    assert!(
        ignored.contains(&serde_json::json!({"id": 2, "why": "moved"})),
        "{ignored:?}"
    );
    // The pose is the one without the card.
    let whole = &lines(&locate_skyline(&photo))[0];
    let of = |line: &serde_json::Value, key: &str| line[key].as_f64().unwrap();
    assert!(turn(of(with, "azimuth_deg"), of(whole, "azimuth_deg")).abs() < 0.05);
    assert!(of(with, "bin_probability") > 0.99 && with["warnings"].as_array().unwrap().is_empty());
    assert!(with["sigma"]["azimuth_deg"].as_f64().unwrap() < 0.05);
}

#[test]
fn a_scene_of_other_places_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    // Every tag stands elsewhere, each by another distance: no majority agrees.
    let text = std::fs::read_to_string(skyline().join("scene.toml")).unwrap();
    let mut number = 0.0;
    let moved: Vec<String> = text
        .lines()
        .map(|line| match line.strip_prefix("centre_mm = [") {
            Some(rest) => {
                number += 1.0;
                let (x, rest) = rest.split_once(',').unwrap();
                format!(
                    "centre_mm = [{},{rest}",
                    x.parse::<f64>().unwrap() + 25.0 * (number * 2.4_f64).sin()
                )
            }
            None => line.to_owned(),
        })
        .collect();
    let scene = write(folder.path(), "scene.toml", moved.join("\n").as_bytes());
    let photo = [skyline().join("normal_002.jpg")];
    let output = locate(&photo, &scene, &skyline().join("camera.yaml"), &["--json"]);
    assert_refused(&output, &["tags disagree", "was a card moved"]);
    assert_eq!(lines(&output)[0]["code"], "high_residual");
}

#[test]
fn the_table_names_bins_and_reasons() {
    let photos = [skyline().join("normal_002.jpg")];
    let output = locate(
        &photos,
        &skyline().join("scene.toml"),
        &skyline().join("camera.yaml"),
        &[],
    );
    let text = stdout(&output);
    assert!(
        text.contains("91.24°") && text.contains("90°/15°/850 mm") && text.contains("100 %"),
        "{text}"
    );
}

/// A name may hold line breaks: each photo has one row of the table all the same.
#[test]
fn a_name_with_a_line_break_stays_in_its_row() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(skyline().join("normal_002.jpg")).unwrap();
    let photos = [write(folder.path(), "a\nb\tc.jpg", &bytes)];
    let files = ["scene.toml", "camera.yaml"].map(|name| skyline().join(name));
    let text = stdout(&locate(&photos, &files[0], &files[1], &[]));
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(
        text.contains("a\\u000ab\\u0009c.jpg ") && text.contains("91.24°"),
        "{text}"
    );
}
