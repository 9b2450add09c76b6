//! Tethered cameras through the program: gphoto2 is stood in for by a script that answers as it does (`tests/data/gphoto2`), in front of which a
//! photographer walks on after each photo.

use crate::common;
use crate::streams::captures;

use std::collections::BTreeSet;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use common::{HANG, assert_refused, home, program, read_json, skyline, stderr, stdout};
use scaleproof_core::files::sha256_hex;

/// The folder of a camera that sees the first photos of the stored session.
fn camera(places: usize) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for place in 0..places {
        let photo = photo(place);
        symlink(&photo, folder.path().join(format!("photo_{place}.jpg"))).unwrap();
        // A live view is smaller, and a few rows are cut off: 680 of 683 rows are a real one's.
        let image = image::open(&photo)
            .unwrap()
            .resize_exact(800, 600, image::imageops::FilterType::Triangle);
        let view = image.crop_imm(0, 1, 800, 597);
        view.save(folder.path().join(format!("view_{place}.jpg"))).unwrap();
    }
    for (name, content) in [("places", places), ("at", 0), ("shots", 0)] {
        set(folder.path(), name, &content.to_string());
    }
    folder
}

fn photo(number: usize) -> PathBuf {
    skyline().join(format!("normal_{number:03}.jpg"))
}

fn set(camera: &Path, name: &str, content: &str) {
    std::fs::write(camera.join(name), content).unwrap();
}

/// The program, with the script before everything else.
fn with_camera(camera: &Path) -> Command {
    let mut command = program();
    let path = std::env::var("PATH").unwrap_or_default();
    let stand_in = home().join("tests/data/gphoto2");
    command.env("PATH", format!("{}:{path}", stand_in.display()));
    command.env("FAKE_CAMERA", camera);
    command
}

fn capture(camera: &Path, session: &Path) -> Output {
    captures(with_camera(camera), "gphoto2", session).output().unwrap()
}

/// The SHA-256 of each photo in a session.
fn kept(session: &Path) -> BTreeSet<String> {
    let listed = read_json(&session.join("session.json"));
    let photos = listed["photos"].as_array().unwrap().iter();
    photos
        .map(|photo| sha256_hex(&std::fs::read(session.join(photo["file"].as_str().unwrap())).unwrap()))
        .collect()
}

fn stored(places: usize) -> BTreeSet<String> {
    (0..places)
        .map(|place| sha256_hex(&std::fs::read(photo(place)).unwrap()))
        .collect()
}

/// What the script was asked for, after checking that the camera was let go and never claimed twice.
fn log(camera: &Path) -> Vec<String> {
    // gphoto2 ends by itself, a moment after it was asked to.
    let start = std::time::Instant::now();
    while camera.join("claimed").exists() {
        assert!(start.elapsed() < HANG, "the camera was not let go");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let log = std::fs::read_to_string(camera.join("log")).unwrap();
    let log: Vec<String> = log.lines().map(|line| line.trim().to_owned()).collect();
    assert!(!log.iter().any(|line| line.starts_with("clash")), "{log:?}");
    log
}

#[test]
fn a_tethered_camera_is_triggered_where_its_live_view_is_right_and_the_photos_are_kept_as_they_are() {
    let (camera, out) = (camera(8), tempfile::tempdir().unwrap());
    let session = out.path().join("session");
    // The third photo finds the card full. The photographer changes it, which moves the camera.
    set(camera.path(), "fail_2", "PTP Store Full\n");
    let output = capture(camera.path(), &session);
    let told = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{told}{}", stderr(&output));
    assert_eq!(kept(&session), stored(8), "no frame of the live view is kept");
    let sidecar = read_json(&session.join("normal_000.capture.json"));
    assert_eq!(sidecar["source"], "Canon EOS 90D IMG_0000.JPG");
    assert!(sidecar["gates"]["moved_px"].is_null(), "a photo is judged by itself");
    assert_eq!(sidecar["camera"]["device"], "Canon EOS 90D");
    assert_eq!(
        stderr(&output).matches("cannot be held").count(),
        1,
        "said once: {}",
        stderr(&output)
    );
    assert!(told.contains("hold it still where it is told"), "{told}");
    assert!(
        told.contains("the camera's card is full: empty it, or put in another"),
        "{told}"
    );
    assert!(told.ends_with("all 8 views are there\n"), "{told}");
    let shots = log(camera.path())
        .iter()
        .filter(|line| line.starts_with("--capture-image"))
        .count();
    assert_eq!(shots, 9, "one photo for each view, and the one that failed: {told}");
}

#[test]
fn without_a_live_view_the_cameras_own_button_takes_the_photos() {
    let (camera, out) = (camera(8), tempfile::tempdir().unwrap());
    let session = out.path().join("session");
    set(camera.path(), "no_preview", "");
    set(camera.path(), "raw", "");
    let output = capture(camera.path(), &session);
    let told = stdout(&output);
    assert_eq!(output.status.code(), Some(0), "{told}{}", stderr(&output));
    assert_eq!(kept(&session), stored(8));
    assert!(told.contains("press its button at each view"), "{told}");
    assert!(log(camera.path()).iter().any(|line| line == "--capture-tethered"));
}

#[test]
fn a_camera_that_breaks_off_is_one_sentence_and_the_same_command_goes_on() {
    let (camera, out) = (camera(2), tempfile::tempdir().unwrap());
    let session = out.path().join("session");
    set(camera.path(), "view_frames", "3");
    let output = capture(camera.path(), &session);
    assert_refused(
        &output,
        &[
            "Canon EOS 90D",
            "the camera broke off: see to its cable and its battery",
        ],
    );
    assert_eq!(
        log(camera.path())
            .iter()
            .filter(|line| *line == "--capture-movie")
            .count(),
        1
    );
    // It is listed, it is in use, it is not there; and a system without gphoto2.
    let list = |json: &[&str]| {
        with_camera(camera.path())
            .args(["capture", "list-cameras"])
            .args(json)
            .output()
            .unwrap()
    };
    assert!(stdout(&list(&[])).contains("gphoto2:usb:001,005  Canon EOS 90D  (tethered, by gphoto2)"));
    let listed: serde_json::Value = serde_json::from_slice(&list(&["--json"]).stdout).unwrap();
    let cameras = listed["cameras"].as_array().unwrap();
    assert!(
        cameras.iter().any(|one| one["source"] == "gphoto2:usb:001,005"),
        "{listed}"
    );
    std::fs::create_dir(camera.path().join("claimed")).unwrap();
    let refused = capture(camera.path(), &session);
    assert_refused(
        &refused,
        &["another program uses the camera: close it, or unmount the camera"],
    );
    set(camera.path(), "unplugged", "");
    assert_refused(
        &capture(camera.path(), &session),
        &["no camera answers gphoto2: plug it in"],
    );
}

/// The real gphoto2 with its driver for folders, the only one that needs no camera here: it takes no photos.
#[test]
fn what_the_real_gphoto2_cannot_trigger_is_refused() {
    let out = tempfile::tempdir().unwrap();
    let (folder, session) = (out.path().join("card"), out.path().join("session"));
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(photo(0), folder.join("a.jpg")).unwrap();
    let source = format!("gphoto2:disk:{}", folder.display());
    let output = captures(program(), &source, &session).output().unwrap();
    let sentence =
        "the Directory Browse takes no photos for a computer: copy its photos into a folder and watch that (watch:DIR)";
    // Where gphoto2 sees no mounted card, its driver for folders is not found.
    let unseen = "no camera answers gphoto2";
    let is_unseen = String::from_utf8_lossy(&output.stderr).contains(unseen);
    assert_refused(&output, &[if is_unseen { unseen } else { sentence }]);
    assert!(!session.exists() && folder.join("a.jpg").exists());
}
