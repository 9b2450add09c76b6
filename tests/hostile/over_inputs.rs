//! Every command that writes, with its output in the place of each of its inputs: whatever it says, no input changes.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::common::{contents, home, program, read_json, skyline, stderr};
use crate::docs::help::Commands;
use crate::hostile::bounded;

/// A line for each command that writes, and `OUT` for what it writes; the other files and folders that a line names are inputs.
const COMMANDS: &[&str] = &[
    "advise session --recorded -o OUT",
    "attack baseline camou frames --detectors detectors --detector scaleproof_car -o OUT",
    "attack baseline er frames --detectors detectors --detector scaleproof_car -o OUT",
    "attack baseline flat frames --detectors detectors --detector scaleproof_car -o OUT",
    "attack baseline import frames --pattern p.png --detectors detectors --detector scaleproof_car -o OUT",
    "attack baseline patches frames --detectors detectors --detector scaleproof_car -o OUT",
    "attack baseline random frames --detectors detectors --detector scaleproof_car -o OUT",
    "attack chart frames -o OUT",
    "attack colours frames -o OUT",
    "attack demo -o OUT",
    "attack evaluate --mesh car.obj --length-mm 440 --pattern a=p.png --detectors detectors --detector scaleproof_car -o OUT",
    "attack history frames -o OUT",
    "attack import frames -o OUT",
    "attack photos session --flat normal=808080 -o OUT",
    "attack render --mesh car.obj --length-mm 440 --pattern a=p.png -o OUT",
    "attack run frames --detectors detectors --detector scaleproof_car --steps 2 -o OUT",
    "attack train-dtn frames -o OUT",
    "calibrate --board board.toml board_00.jpg board_01.jpg board_02.jpg board_06.jpg -o OUT",
    "camera convert camera.yaml --format ros -o OUT",
    "camera guess a.jpg -o OUT",
    "capture --scene scene.toml --camera camera.yaml --source folder:session --variant a --place b --headless -o OUT",
    "chart capture --session session -o OUT",
    "chart envelope --session session --truth truth.json -o OUT",
    "chart locate --session session --truth truth.json -o OUT",
    "chart score --session session --detectors detectors --detector scaleproof_car -o OUT",
    "chart sigma --session session --truth truth.json --views 0 -o OUT",
    "chart stability --session session --truth truth.json --views 1 -o OUT",
    "colour read a.jpg b.jpg -o OUT",
    "compare session --recorded -o OUT",
    "demo -o OUT",
    "detectors add net.onnx -o OUT",
    "detectors check a.jpg --detectors detectors --detector scaleproof_car --save OUT",
    "detectors speed a.jpg --detectors detectors --detector scaleproof_car --machine m -o OUT",
    "merge part.scaleproof -o OUT",
    "pattern check p.png --printer printer.toml -o OUT",
    "pattern import p.png --cells 2 -o OUT",
    "pattern random --cells 4 --seed 1 -o OUT",
    "plan --seal OUT --scene scene.toml --texture normal random=p.png --detector yolox_nano --drop 0.3",
    "print board --type chessboard --squares 7x5 --square-mm 20 --printer printer.toml --format pdf -o OUT",
    "print chart --printer printer.toml --format pdf -o OUT",
    "print check --printer printer.toml --format pdf -o OUT",
    "print patch --scene scene.toml --patch p.png --panel left --at-mm 0,55 --size-mm 40 --format pdf -o OUT",
    "print tags --scene scene.toml --printer printer.toml --format pdf -o OUT",
    "print template --pattern p.png --tile-mm 40 --size-mm 100x100 --printer printer.toml --format pdf -o OUT",
    // The printer's own file is measured again.
    "print verify --x-mm 99.5 --y-mm 100.5 -o OUT",
    "print wrap --panels --mesh car.obj --length-mm 440 --pattern p.png --tile-mm 40 --printer printer.toml --format pdf -o OUT",
    "scene new --mesh car.obj --length-mm 440 --radius-mm 400 -o OUT",
    "score session --recorded -o OUT",
    "session export session --format coco -o OUT",
    "session from-video walk.mp4 --scene scene.toml --camera camera.yaml --variant a --place b -o OUT",
    "survey a.jpg b.jpg --scene scene.toml --camera camera.yaml --fixed mat -o OUT",
    "texture bake --texture car.obj --size 64 -o OUT",
    "texture show --texture car.obj -o OUT",
];

/// Inputs of every kind; the session has one photo of each texture.
pub(super) fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let copied = |from: &Path, to: &str| {
        let to = folder.path().join(to);
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(from, to).unwrap();
    };
    for name in ["car.obj", "paint.mtl", "ok.png"] {
        copied(&home().join("tests/data/cases").join(name), name);
    }
    for name in ["board_00.jpg", "board_01.jpg", "board_02.jpg", "board_06.jpg"] {
        copied(&home().join("captures/board").join(name), name);
    }
    for name in ["scene.toml", "camera.yaml", "truth.json"] {
        copied(&skyline().join(name), name);
    }
    copied(&skyline().join("normal_000.jpg"), "a.jpg");
    copied(&skyline().join("normal_001.jpg"), "b.jpg");
    copied(&home().join("detectors/scaleproof_car.onnx"), "net.onnx");
    copied(&home().join("captures/walk/normal.mp4"), "walk.mp4");
    for (from, to) in [
        (skyline(), "session"),
        (home().join("captures/skyline_frames"), "frames"),
        (home().join("detectors"), "detectors"),
    ] {
        for path in contents(&from).keys() {
            copied(path, &format!("{to}/{}", path.strip_prefix(&from).unwrap().display()));
        }
    }
    let path = folder.path().join("session/session.json");
    let mut session = read_json(&path);
    let photos = session["photos"].as_array_mut().unwrap();
    *photos = vec![photos[0].take(), photos[8].take()];
    std::fs::write(&path, session.to_string()).unwrap();
    for made in [
        "pattern random --cells 4 --seed 1 -o p.png",
        "print verify --x-mm 99.5 --y-mm 100.5 -o printer.toml",
        "print board --type charuco --squares 9x7 --square-mm 22 --marker-mm 16 -o board.pdf --definition board.toml",
    ] {
        let output = program()
            .current_dir(folder.path())
            .args(made.split(' '))
            .output()
            .unwrap();
        assert!(output.status.success(), "{made}: {}", stderr(&output));
    }
    folder
}

#[test]
fn no_command_changes_an_input() {
    let folder = folder();
    let before = contents(folder.path());
    for line in COMMANDS {
        let inputs = line.split(' ').filter(|word| folder.path().join(word).exists());
        for input in inputs {
            let mut command = program();
            command
                .current_dir(folder.path())
                .args(line.split(' ').map(|word| if word == "OUT" { input } else { word }));
            let run = bounded::run(&mut command);
            assert!(
                matches!(run.output.status.code(), Some(0 | 2)),
                "{line} over {input}: {}",
                stderr(&run.output)
            );
            let after = contents(folder.path());
            let changed: Vec<&PathBuf> = before
                .iter()
                .filter(|(path, bytes)| after.get(*path) != Some(*bytes))
                .map(|(path, _)| path)
                .collect();
            assert!(changed.is_empty(), "{line} over {input} changes {changed:?}");
        }
    }
}

/// A new command needs its line above.
#[test]
fn every_command_that_writes_is_tried() {
    let commands = Commands::of_program();
    let name_of = |line: &&str| -> String {
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        let name = (1..=words.len())
            .rev()
            .find(|count| commands.is_command(&words[..*count]));
        words[..name.unwrap_or_else(|| panic!("{line} is no command"))].join(" ")
    };
    let tried: BTreeSet<String> = COMMANDS.iter().map(name_of).collect();
    let missing: Vec<String> = commands.writing().difference(&tried).cloned().collect();
    assert!(missing.is_empty(), "no line above tries {missing:?}");
}
