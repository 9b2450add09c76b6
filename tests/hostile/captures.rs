//! A session's folder and names that a capture did not choose.

use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{assert_refused, copy_of_skyline, program, read_json, skyline, stderr};

fn capture(source: &Path, variant: &str, session: &Path) -> Command {
    let mut command = program();
    command
        .arg("capture")
        .arg("--source")
        .arg(format!("replay:{}", source.display()));
    command.arg("--scene").arg(skyline().join("scene.toml"));
    command.arg("--camera").arg(skyline().join("camera.yaml"));
    // With the sign, a name may begin with a dash.
    command
        .arg(format!("--variant={variant}"))
        .args(["--place", "yard", "-o"])
        .arg(session);
    command
}

fn output(command: &mut Command) -> Output {
    command.output().unwrap()
}

/// What lies where the lock should be, and whether a capture goes on.
#[test]
fn the_lock_never_changes_what_is_in_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let photo = folder.path().join("photo.jpg");
    std::fs::write(&photo, "a photo").unwrap();
    type Prepare<'a> = &'a dyn Fn(&Path);
    let prepare: [(&str, Prepare); 3] = [
        ("link", &|lock| symlink(&photo, lock).unwrap()),
        ("folder", &|lock| std::fs::create_dir(lock).unwrap()),
        ("pipe", &|lock| {
            assert!(Command::new("mkfifo").arg(lock).status().unwrap().success())
        }),
    ];
    for (name, prepare) in prepare {
        let session = folder.path().join(name);
        std::fs::create_dir(&session).unwrap();
        prepare(&session.join(".capture.lock"));
        assert_refused(
            &output(&mut capture(&skyline(), "normal", &session)),
            &[".capture.lock", "remove it"],
        );
        assert_eq!(std::fs::read(&photo).unwrap(), b"a photo", "{name}");
    }
    // A file there is only locked.
    let session = folder.path().join("file");
    std::fs::create_dir(&session).unwrap();
    std::fs::write(session.join(".capture.lock"), "content").unwrap();
    output(&mut capture(&skyline(), "normal", &session));
    assert_eq!(std::fs::read(session.join(".capture.lock")).unwrap(), b"content");
}

/// Variants, and how the names of their photos begin.
const NAMES: [(&str, &str); 5] = [
    ("été", "t_"),
    ("-rf", "rf_"),
    ("迷彩", "photo_"),
    ("../../etc", "etc_"),
    ("checker 16", "checker-16_"),
];

#[test]
fn photos_are_named_so_that_no_program_takes_them_for_options_or_paths() {
    for (variant, beginning) in NAMES {
        let source = copy_of_skyline();
        let list = source.path().join("session.json");
        let mut session = read_json(&list);
        for photo in session["photos"].as_array_mut().unwrap() {
            if photo["variant"] == "normal" {
                photo["variant"] = variant.into();
            }
        }
        std::fs::write(&list, session.to_string()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let ended = output(&mut capture(source.path(), variant, folder.path()));
        let taken = read_json(&folder.path().join("session.json"));
        let taken = taken["photos"].as_array().unwrap();
        assert!(!taken.is_empty(), "{variant}: {}", stderr(&ended));
        for photo in taken {
            let file = photo["file"].as_str().unwrap();
            assert!(file.starts_with(beginning), "{variant}: {file}");
        }
    }
}

#[test]
fn what_is_taken_back_stays_in_the_session() {
    let folder = tempfile::tempdir().unwrap();
    let (session, elsewhere) = (folder.path().join("session"), folder.path().join("elsewhere"));
    std::fs::create_dir(&elsewhere).unwrap();
    output(&mut capture(&skyline(), "normal", &session));
    symlink(&elsewhere, session.join("taken_back")).unwrap();
    let before = std::fs::read(session.join("session.json")).unwrap();
    let undone = output(capture(&skyline(), "normal", &session).arg("--undo"));
    assert_refused(&undone, &["taken_back", "remove it"]);
    assert_eq!(std::fs::read_dir(&elsewhere).unwrap().count(), 0);
    assert_eq!(std::fs::read(session.join("session.json")).unwrap(), before);
}
