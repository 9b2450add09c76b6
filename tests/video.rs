//! `session from-video`: the stored walk round the model (`captures/walk`, rendered, with its truth) becomes a session.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use scaleproof_core::files::environment;

use crate::common::{HANG, assert_refused, home, kills, program, read_json, stderr, write_program};

fn walk(name: &str) -> PathBuf {
    home().join("captures/walk").join(name)
}

/// `session from-video` with the stored scene and camera.
fn from_video(video: &Path, variant: &str, session: &Path) -> Command {
    with_camera(video, &walk("camera.yaml"), variant, session)
}

fn with_camera(video: &Path, camera: &Path, variant: &str, session: &Path) -> Command {
    let mut command = program();
    command.args(["session", "from-video"]).arg(video);
    command
        .arg("--scene")
        .arg(walk("scene.toml"))
        .arg("--camera")
        .arg(camera);
    command
        .args(["--variant", variant, "--place", "table", "--json", "-o"])
        .arg(session);
    command
}

fn answer(mut command: Command) -> Value {
    let done = command.output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

fn truth(variant: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(walk(&format!("{variant}.truth.json"))).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    all["frames"].as_array().unwrap().clone()
}

fn turn(from: f64, to: f64) -> f64 {
    (to - from + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn a_walk_becomes_a_session_of_all_views_and_a_second_one_its_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    for variant in ["normal", "random"] {
        let made = answer(from_video(&walk(&format!("{variant}.mp4")), variant, &session));
        let (chosen, truth) = (made["chosen"].as_array().unwrap(), truth(variant));
        assert_eq!(chosen.len(), 8, "{made}");
        assert_eq!(made["frames"], truth.len());
        assert!(made["empty_bins"].as_array().unwrap().is_empty());
        for one in chosen {
            let number = one["frame"].as_u64().unwrap() as usize;
            let (is, expected) = (&one["viewpoint"]["azimuth_deg"], &truth[number]["azimuth_deg"]);
            let off = turn(expected.as_f64().unwrap(), is.as_f64().unwrap());
            assert!(off.abs() < 0.1, "{variant}, frame {number}: {is}, not {expected}");
            let smeared = |frame: &Value| frame["blur_px"].as_f64().unwrap();
            let is_beside =
                |other: &&Value| turn(expected.as_f64().unwrap(), other["azimuth_deg"].as_f64().unwrap()).abs() < 5.0;
            let sharper = truth
                .iter()
                .filter(is_beside)
                .map(smeared)
                .fold(f64::INFINITY, f64::min);
            let own = smeared(&truth[number]);
            assert!(
                own <= 1.5 || own <= sharper,
                "frame {number} is smeared by {own} px, another near it by {sharper}"
            );
            let photo = session.join(one["file"].as_str().unwrap());
            let sidecar: Value =
                serde_json::from_slice(&std::fs::read(photo.with_extension("capture.json")).unwrap()).unwrap();
            assert_eq!(sidecar["photo"]["frame"]["number"], one["frame"]);
            if variant == "random" {
                let apart = one["pair"]["difference"]["apart_deg"].as_f64().unwrap();
                assert!(apart < 3.0, "a pair is {apart}° apart");
            }
        }
        for picture in ["contact_sheet", "coverage"] {
            assert!(Path::new(made[picture].as_str().unwrap()).is_file());
        }
    }
    // Located again, as every photo is: pairs are in the same bins.
    let shown = program()
        .args(["session", "show", "--json"])
        .arg(&session)
        .output()
        .unwrap();
    assert!(shown.status.success());
    let list: Value = serde_json::from_slice(&std::fs::read(session.join("session.json")).unwrap()).unwrap();
    let photos = list["photos"].as_array().unwrap();
    assert_eq!(photos.len(), 16);
    assert!(
        photos
            .iter()
            .all(|photo| photo["frame"]["sha256"].as_str().unwrap().len() == 64)
    );
    let again = from_video(&walk("random.mp4"), "random", &session).output().unwrap();
    let sentence = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(
        again.status.code() == Some(2) && sentence.contains("already"),
        "{sentence}"
    );
    // A capture goes on in the session, and leaves what is there.
    let photos = || read_json(&session.join("session.json"))["photos"].clone();
    let before = photos();
    let mut capture = program();
    capture.args(["capture", "--variant", "normal", "--place", "table", "--undo"]);
    capture
        .arg("--scene")
        .arg(walk("scene.toml"))
        .arg("--camera")
        .arg(walk("camera.yaml"));
    let done = capture.arg("-o").arg(&session).output().unwrap();
    assert!(
        stderr(&done).contains("no photo of normal to take back"),
        "{}",
        stderr(&done)
    );
    assert_eq!(photos(), before);
}

/// A second or two of a walk have few frames to tell how well its motion is known.
#[test]
fn frames_of_short_parts_are_as_far_off_as_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let truth = truth("normal");
    let (mut errors, mut within_two) = (0, 0);
    for (from, to) in [(4, 5), (5, 6), (4, 6), (3, 6), (8, 10)] {
        let session = folder.path().join(format!("{from}_{to}"));
        let mut command = from_video(&walk("normal.mp4"), "normal", &session);
        command.args(["--from", &from.to_string(), "--to", &to.to_string()]);
        for one in answer(command)["chosen"].as_array().unwrap() {
            let number = one["frame"].as_u64().unwrap() as usize;
            let [is, sigma] = ["viewpoint", "sigma"].map(|of| one[of]["azimuth_deg"].as_f64().unwrap());
            let off = turn(truth[number]["azimuth_deg"].as_f64().unwrap(), is).abs();
            println!("{from} to {to} s, frame {number}: {off:.3}° at σ {sigma:.3}°");
            assert!(
                off < 3.0 * sigma,
                "{from} to {to} s, frame {number}: {off}° off at σ {sigma}°"
            );
            errors += 1;
            within_two += usize::from(off < 2.0 * sigma);
        }
    }
    // Of nine normal errors one is expected beyond 2 σ every third time.
    assert!(errors >= 8 && within_two + 1 >= errors, "{within_two} of {errors}");
}

/// 12 pictures a second in a film of 24 frames, as phones make them in poor light: the camera does not rest between two frames that are one picture.
#[test]
fn a_picture_that_is_shown_twice_counts_once() {
    let folder = tempfile::tempdir().unwrap();
    let (film, session) = (folder.path().join("twice.mp4"), folder.path().join("session"));
    let mut encode = Command::new("ffmpeg");
    encode.args(["-v", "error", "-t", "4", "-i"]).arg(walk("normal.mp4"));
    encode.args(["-vf", "fps=24", "-c:v", "libx264", "-preset", "ultrafast", "-crf", "14"]);
    assert!(encode.arg(&film).status().unwrap().success());
    let mut command = from_video(&film, "normal", &session);
    command.args(["--per-bin", "3"]);
    let made = answer(command);
    let (frames, repeated) = (
        made["frames"].as_u64().unwrap(),
        made["refused"]["repeated"].as_u64().unwrap(),
    );
    assert!(repeated.abs_diff(frames / 2) <= 1, "{repeated} of {frames}");
    let (chosen, truth) = (made["chosen"].as_array().unwrap(), truth("normal"));
    assert!(chosen.len() >= 6, "{made}");
    for one in chosen {
        let number = one["frame"].as_u64().unwrap() as usize;
        let [is, sigma] = ["viewpoint", "sigma"].map(|of| one[of]["azimuth_deg"].as_f64().unwrap());
        let off = turn(truth[number / 2]["azimuth_deg"].as_f64().unwrap(), is);
        assert!(off.abs() < 3.0 * sigma, "frame {number}: {off}° off at σ {sigma}°");
    }
}

/// The system's ffmpeg, in a folder of its own, whose frames stop after some 1280 × 720 ones of luma and chroma; what follows waits at a gate.
fn held_ffmpeg(programs: &Path, gate: &Path, frames: usize) {
    std::fs::create_dir(programs).unwrap();
    std::os::unix::fs::symlink(environment::program("ffprobe").unwrap(), programs.join("ffprobe")).unwrap();
    assert!(Command::new("mkfifo").arg(gate).status().unwrap().success());
    let (system, gate, bytes) = (
        environment::program("ffmpeg").unwrap(),
        gate.display(),
        frames * 1280 * 720 * 3 / 2,
    );
    let script = format!(
        "case \"$*\" in *yuv420p*rawvideo*pipe:1) '{}' \"$@\" | {{ head -c {bytes}; cat '{gate}'; }} ;; *) exec '{}' \"$@\" ;; esac",
        system.display(),
        system.display(),
    );
    write_program(&programs.join("ffmpeg"), &script);
}

#[test]
fn ctrl_c_ends_a_run_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    let (programs, gate) = (folder.path().join("bin"), folder.path().join("gate"));
    held_ffmpeg(&programs, &gate, 20);
    let mut running = from_video(&walk("normal.mp4"), "normal", &session)
        .env("PATH", format!("{}:/usr/bin:/bin", programs.display()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while !session.exists() || !kills::is_caught(2, &running) {
        assert!(began.elapsed() < HANG && running.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(5));
    }
    // As Ctrl-C in a terminal.
    kills::send(&["-INT"], &running);
    let ended = running.wait().unwrap();
    // Whoever still waits there goes.
    drop(std::fs::OpenOptions::new().read(true).write(true).open(&gate).unwrap());
    assert_eq!(ended.code(), Some(130));
    assert!(!session.exists());
}

#[test]
fn what_cannot_be_used_is_refused_in_one_sentence_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("session");
    let bytes = std::fs::read(walk("normal.mp4")).unwrap();
    let cut = folder.path().join("cut.mp4");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let words = folder.path().join("words.mp4");
    std::fs::write(&words, "no video").unwrap();
    // Another run is at work on the session.
    let busy = folder.path().join("busy");
    std::fs::create_dir(&busy).unwrap();
    let lock = std::fs::File::create(busy.join(".capture.lock")).unwrap();
    lock.lock().unwrap();
    let second = from_video(&walk("normal.mp4"), "normal", &busy).output().unwrap();
    assert_refused(&second, &["another run is filling"]);
    let photos = format!("normal={}", walk("").display());
    let added = program()
        .args(["session", "new"])
        .arg(&busy)
        .arg(photos)
        .output()
        .unwrap();
    assert_refused(&added, &["another run is filling"]);
    assert_eq!(std::fs::read_dir(&busy).unwrap().count(), 1);
    drop(lock);
    let (missing, of_photos) = (
        folder.path().join("missing.mp4"),
        home().join("calibration/skyline.yaml"),
    );
    assert_refused(
        &from_video(&missing, "normal", &session).output().unwrap(),
        &["missing.mp4"],
    );
    let walked = walk("normal.mp4");
    let other = with_camera(&walked, &of_photos, "normal", &session).output().unwrap();
    assert_refused(&other, &["must be of its videos"]);
    for video in [&cut, &words] {
        let done = from_video(video, "normal", &session).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        let errors: Vec<&str> = said.lines().filter(|line| line.starts_with("error: ")).collect();
        assert!(done.status.code() == Some(2) && errors.len() == 1, "{said}");
        assert!(!session.exists(), "{said}");
    }
    // Without ffmpeg.
    let mut without = from_video(&walk("normal.mp4"), "normal", &session);
    let done = without.env("PATH", folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(
        done.status.code() == Some(2) && said.contains("apt install ffmpeg"),
        "{said}"
    );
    assert!(!session.exists());
}

/// One that has lost an option, as a later version may.
#[test]
fn what_ffmpeg_says_of_its_own_options_is_not_the_film_s_fault() {
    let folder = tempfile::tempdir().unwrap();
    let (programs, session) = (folder.path().join("bin"), folder.path().join("session"));
    std::fs::create_dir(&programs).unwrap();
    std::os::unix::fs::symlink(environment::program("ffprobe").unwrap(), programs.join("ffprobe")).unwrap();
    let script = "case \"$*\" in
  *-version) echo 'ffmpeg version 99.0-next Copyright' ;;
  *) echo '[fatal] Unrecognized option: showinfo' >&2; exit 8 ;;
esac";
    write_program(&programs.join("ffmpeg"), script);
    let mut command = from_video(&walk("normal.mp4"), "normal", &session);
    let output = command
        .env("PATH", format!("{}:/usr/bin:/bin", programs.display()))
        .output()
        .unwrap();
    assert_refused(
        &output,
        &[
            "ffmpeg 99.0-next does not take",
            "unrecognized option: showinfo",
            "install another",
        ],
    );
    assert!(!session.exists());
}

/// The film is another one when photos of it are made: they would stand under the hash of the first.
#[test]
#[cfg(target_os = "linux")]
fn a_film_that_is_replaced_while_it_is_read_makes_no_photos() {
    let folder = tempfile::tempdir().unwrap();
    let (film, session) = (folder.path().join("film.mp4"), folder.path().join("session"));
    std::fs::copy(walk("normal.mp4"), &film).unwrap();
    let mut command = from_video(&film, "normal", &session);
    command
        .args(["--to", "2"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    // Before the first photo takes its name.
    let child = kills::stop_at(&mut command, folder.path(), 1);
    std::fs::copy(walk("random.mp4"), folder.path().join("other.mp4")).unwrap();
    std::fs::rename(folder.path().join("other.mp4"), &film).unwrap();
    kills::send(&["-CONT"], &child);
    let output = child.wait_with_output().unwrap();
    assert_refused(&output, &["film.mp4", "changed while it was read"]);
    assert!(!session.exists(), "nothing of it stays");
}

/// The camera file of the photos for the film of another lens.
#[test]
fn a_focal_length_that_fits_in_no_frame_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let camera = folder.path().join("camera.yaml");
    let text = std::fs::read_to_string(walk("camera.yaml")).unwrap();
    let fx = scaleproof_pose::camera::Camera::open(&walk("camera.yaml")).unwrap().fx;
    let other = text.replace(&fx.to_string(), &(1.25 * fx).to_string());
    assert_ne!(other, text);
    std::fs::write(&camera, other).unwrap();
    let mut command = with_camera(&walk("normal.mp4"), &camera, "normal", &folder.path().join("session"));
    let output = command.args(["--to", "4"]).output().unwrap();
    assert_refused(&output, &["can be a photo", "the focal length in", "camera.yaml"]);
}
