//! Texts from elsewhere that would move the cursor, colour the terminal or turn the direction of reading.

use std::path::Path;
use std::process::Output;

use crate::common::{assert_refused, copy_of_skyline, home, program, read_json, skyline};

/// Clears the screen; the same in one byte of C1; text that reads from right to left; a line that overwrites itself.
const EVIL: &str = "a\u{1b}[2Jb\u{9b}31mc\u{202e}d\re";

fn check(what: &str, output: &Output) {
    for (stream, bytes) in [("standard output", &output.stdout), ("standard error", &output.stderr)] {
        let text = std::str::from_utf8(bytes).unwrap();
        let hidden = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || ('\u{202a}'..='\u{202e}').contains(&c);
        assert!(!text.contains(hidden), "{what}, {stream}: {text:?}");
    }
    let said = [&output.stdout[..], &output.stderr].concat();
    assert!(
        String::from_utf8_lossy(&said).contains("\\u001b[2Jb\\u009b31m"),
        "{what} says the name"
    );
}

fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

fn path(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn names_of_files_are_shown_harmless() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(EVIL);
    std::fs::write(&file, "no picture").unwrap();
    let (scene, camera) = (skyline().join("scene.toml"), skyline().join("camera.yaml"));
    let locate = [
        "locate",
        path(&file),
        "--scene",
        path(&scene),
        "--camera",
        path(&camera),
    ];
    check("locate", &run(&locate));
    check("locate --json", &run(&[&locate[..], &["--json"]].concat()));
    check("pattern check", &run(&["pattern", "check", path(&file)]));
    check("camera show", &run(&["camera", "show", path(&file)]));
    let board = home().join("calibration/charuco_9x7_22mm.toml");
    check("calibrate", &run(&["calibrate", "--board", path(&board), path(&file)]));
}

#[test]
fn variants_and_places_of_a_session_have_no_control_characters() {
    for key in ["variant", "place"] {
        let session = copy_of_skyline();
        let list = session.path().join("session.json");
        let mut content = read_json(&list);
        content["photos"][3][key] = EVIL.into();
        std::fs::write(&list, content.to_string()).unwrap();
        let out = tempfile::tempdir().unwrap();
        let scored = run(&["score", path(session.path()), "--recorded", "--out", path(out.path())]);
        assert_refused(&scored, &[key, "control characters"]);
        assert!(!String::from_utf8_lossy(&scored.stderr).contains(['\u{1b}', '\u{9b}', '\u{202e}', '\r']));
    }
}

#[test]
fn names_of_paints_are_shown_harmless() {
    let folder = tempfile::tempdir().unwrap();
    let (palette, pattern, sheet) = (
        folder.path().join("paints.toml"),
        folder.path().join("p.png"),
        folder.path().join("out.pdf"),
    );
    // As a TOML string writes it; that it comes twice is what is wrong.
    let name: String = EVIL.chars().map(|c| format!("\\U{:08X}", u32::from(c))).collect();
    std::fs::write(
        &palette,
        format!("[[paint]]\nname = \"{name}\"\nrgb = [200, 0, 0]\n[[paint]]\nname = \"{name}\"\nrgb = [0, 0, 9]\n"),
    )
    .unwrap();
    let made = run(&["pattern", "random", "--cells", "2", "--seed", "1", "-o", path(&pattern)]);
    assert!(made.status.success());
    let arguments = [
        "--tile-mm",
        "60",
        "--size-mm",
        "100x60",
        "--palette",
        path(&palette),
        "-o",
        path(&sheet),
    ];
    let printed = run(&[&["print", "template", "--pattern", path(&pattern)][..], &arguments].concat());
    assert_eq!(printed.status.code(), Some(2));
    check("print template", &printed);
}
