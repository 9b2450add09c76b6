//! Outputs that lead somewhere else: links, pipes, sockets, standard output; and runs that are killed while their files take their places.

use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

use crate::common::kills::kill_at;
use crate::common::{assert_refused, home, program, read_json, skyline, stderr};
use crate::hostile::bounded;

/// Commands with one output file; `OUT` stands for it.
const COMMANDS: [&str; 2] = [
    "print check --format pdf -o OUT",
    "pattern random --cells 4 --seed 1 -o OUT",
];

fn command(arguments: &str, out: &str) -> Command {
    let mut command = program();
    command.args(
        arguments
            .split_whitespace()
            .map(|argument| argument.replace("OUT", out)),
    );
    command
}

fn run(arguments: &str, out: &Path) -> Output {
    bounded::run(&mut command(arguments, &out.display().to_string())).output
}

#[test]
fn a_link_stays_and_its_target_is_written() {
    for arguments in COMMANDS {
        let folder = tempfile::tempdir().unwrap();
        let (target, link, second) = (
            folder.path().join("target"),
            folder.path().join("link"),
            folder.path().join("second"),
        );
        std::fs::write(&target, "").unwrap();
        symlink("target", &link).unwrap();
        symlink(&link, &second).unwrap();
        let output = run(arguments, &second);
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        assert!(second.is_symlink() && link.is_symlink(), "{arguments:?}");
        assert!(std::fs::metadata(&target).unwrap().len() > 20, "{arguments:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3, "{arguments:?}");
    }
}

#[test]
fn a_pipe_is_written_to_and_stays_a_pipe() {
    for arguments in COMMANDS {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reads = pipe.clone();
        let reader = std::thread::spawn(move || std::fs::read(reads).unwrap());
        let output = run(arguments, &pipe);
        // Whoever opens it next would wait for ever, were nothing written.
        drop(std::fs::OpenOptions::new().read(true).write(true).open(&pipe));
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        assert!(reader.join().unwrap().len() > 20, "{arguments:?}");
        assert!(!std::fs::metadata(&pipe).unwrap().is_file(), "{arguments:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{arguments:?}");
    }
}

#[test]
fn a_dash_is_standard_output_where_the_file_is_alone() {
    for arguments in COMMANDS {
        let folder = tempfile::tempdir().unwrap();
        let named = folder.path().join("named");
        assert!(run(arguments, &named).status.success());
        let output = command(arguments, "-").current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        assert_eq!(output.stdout, std::fs::read(&named).unwrap(), "{arguments:?}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{arguments:?}");
    }
}

/// Arguments, and words of the refusal.
const REFUSED: [(&str, &[&str]); 19] = [
    ("print check -o locked", &["locked", "write-protected"]),
    ("print check -o socket", &["socket", "is no file"]),
    ("print check -o dangling", &["dangling", "symbolic link to nothing"]),
    ("print check -o folder", &["folder", "in its place"]),
    ("score SESSION --recorded -o -", &["--output must be a folder"]),
    ("chart capture --session SESSION -o -", &["--output must be a folder"]),
    ("print check --format svg -o -", &["one file per page"]),
    ("print check -o y.png", &["y.png", ".pdf or .svg", "--format"]),
    ("print check -o y", &["y does not say", ".pdf or .svg"]),
    ("print chart -o y.png", &["y.png", ".pdf or .svg"]),
    (
        "print tags --scene SESSION/scene.toml -o y.tif",
        &["y.tif", ".pdf or .svg"],
    ),
    (
        "print board --type chessboard --squares 7x5 --square-mm 20 -o y.png",
        &["y.png", ".pdf or .svg"],
    ),
    (
        "print template --pattern SHEETS/random16.png --tile-mm 118 --size-mm 100x100 -o y.png",
        &["y.png", ".pdf or .svg"],
    ),
    (
        "print template --pattern SHEETS/random16.png --tile-mm 118 --size-mm 118x118 --paints 4 -o y.png",
        &["y.png", ".pdf or .svg"],
    ),
    (
        "print wrap --panels --scene SHEETS/ring4.toml --pattern SHEETS/random16.png --tile-mm 118 --paper a3 -o y",
        &["y does not say", ".pdf or .svg"],
    ),
    (
        "print patch --scene SHEETS/ring4.toml --patch SHEETS/random16.png --panel left --at-mm 0,50 --size-mm 80 --paper a3 -o y.html",
        &["y.html", ".pdf or .svg"],
    ),
    ("pattern random -o y.pdf", &["y.pdf would hold PNG", ".png"]),
    (
        "print board --type chessboard --squares 7x5 --square-mm 20 -o -",
        &["--definition"],
    ),
    (
        "print board --type chessboard --squares 7x5 --square-mm 20 -o - --definition -",
        &["only one file"],
    ),
];

#[test]
fn what_takes_no_file_is_refused_and_stays() {
    for (arguments, words) in REFUSED {
        let folder = tempfile::tempdir().unwrap();
        let _socket = UnixListener::bind(folder.path().join("socket")).unwrap();
        symlink("nowhere", folder.path().join("dangling")).unwrap();
        std::fs::create_dir(folder.path().join("folder")).unwrap();
        let locked = std::fs::File::create(folder.path().join("locked")).unwrap();
        let mut permissions = locked.metadata().unwrap().permissions();
        permissions.set_readonly(true);
        locked.set_permissions(permissions).unwrap();
        let before = names(folder.path());
        let session = skyline().display().to_string();
        let sheets = home().join("print_templates").display().to_string();
        let arguments = arguments
            .split_whitespace()
            .map(|argument| argument.replace("SESSION", &session).replace("SHEETS", &sheets));
        let output = program().args(arguments).current_dir(folder.path()).output().unwrap();
        assert_refused(&output, words);
        assert_eq!(names(folder.path()), before);
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn score(out: &Path, confidence: &str) -> Command {
    let mut command = program();
    command
        .arg("score")
        .arg(skyline())
        .args(["--recorded", "--confidence", confidence, "--out"])
        .arg(out);
    command
}

#[test]
#[cfg(target_os = "linux")]
fn a_run_killed_between_two_of_its_files_is_finished_by_the_next_in_that_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    assert!(score(&out, "0.5").output().unwrap().status.success());
    let expected = folder.path().join("expected");
    assert!(score(&expected, "0.25").output().unwrap().status.success());
    let mut killed = score(&out, "0.25");
    let killed = kill_at(&mut killed, folder.path(), 3).output().unwrap();
    assert_eq!(killed.status.code(), None, "it was killed: {}", stderr(&killed));
    let confidence = |folder: &Path| {
        read_json(&folder.join("summary.json"))["hit_confidence"]
            .as_f64()
            .unwrap()
    };
    let same = |name: &str| std::fs::read(out.join(name)).unwrap() == std::fs::read(expected.join(name)).unwrap();
    let new = names(&expected).iter().filter(|name| same(name)).count();
    assert!(
        new >= 2 && new < names(&expected).len(),
        "{new} files are of the killed run"
    );
    // Any run that writes there finishes it first.
    let pattern = out.join("p.png");
    assert!(run(COMMANDS[1], &pattern).status.success());
    std::fs::remove_file(pattern).unwrap();
    assert_eq!(confidence(&out), 0.25);
    assert!(names(&expected).iter().all(|name| same(name)));
    assert_eq!(names(&out), names(&expected), "nothing half-written stays");
}

#[test]
#[cfg(target_os = "linux")]
fn what_a_killed_run_left_half_written_is_removed_by_a_later_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut killed = command(COMMANDS[1], &out.join("p.png").display().to_string());
    kill_at(&mut killed, folder.path(), 1);
    assert_eq!(killed.output().unwrap().status.code(), None);
    let left = names(&out);
    assert!(matches!(&left[..], [name] if name.ends_with(".partial")), "{left:?}");
    // It is younger than what a run may be at work on; a day later it is not.
    let yesterday = std::time::SystemTime::now() - Duration::from_secs(86_400);
    let partial = std::fs::File::options().write(true).open(out.join(&left[0])).unwrap();
    partial.set_modified(yesterday).unwrap();
    // A folder that was being filled, as `session new --copy` does.
    let half = out.join(".session.4711_0.partial");
    std::fs::create_dir(&half).unwrap();
    std::fs::write(half.join("photo.jpg"), "photo").unwrap();
    std::fs::File::open(&half).unwrap().set_modified(yesterday).unwrap();
    // Somebody else's hidden file is none of ours.
    std::fs::write(out.join(".mine.7.partial"), "").unwrap();
    assert!(run(COMMANDS[1], &out.join("p.png")).status.success());
    assert_eq!(names(&out), [".mine.7.partial", "p.png"]);
}

/// A note in a folder from elsewhere.
#[test]
fn a_forged_note_moves_nothing_out_of_its_folder_or_over_what_it_does_not_name() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(folder.path().join("victim"), "victim").unwrap();
    std::fs::write(out.join("photo.jpg"), "photo").unwrap();
    std::fs::write(out.join("evil"), "evil").unwrap();
    let note = "evil\n../victim\n.../victim.1_0.partial\n./../victim.1_0.partial\n";
    std::fs::write(out.join(".1.scaleproof-journal"), note).unwrap();
    assert!(run(COMMANDS[1], &out.join("p.png")).status.success());
    assert_eq!(std::fs::read(folder.path().join("victim")).unwrap(), b"victim");
    assert_eq!(names(&out), ["evil", "p.png", "photo.jpg"]);
}

/// Whoever may read a folder may lock it.
#[test]
fn a_folder_that_somebody_holds_locked_is_said_to_be() {
    let out = tempfile::tempdir().unwrap();
    let held = std::fs::File::open(out.path()).unwrap();
    held.lock().unwrap();
    let ended = score(out.path(), "0.5").output().unwrap();
    assert_eq!(ended.status.code(), Some(2));
    assert!(stderr(&ended).contains("lock"), "{}", stderr(&ended));
    assert_eq!(names(out.path()), [""; 0]);
}

/// The files of a report of other detectors go, a stranger's file stays.
#[test]
fn results_of_detectors_that_are_no_longer_in_a_report_go() {
    let out = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(out.path().join(name), text).unwrap();
    write(
        "summary.json",
        r#"{"results": [{"detector": "mine"}, {"detector": "../outside"}]}"#,
    );
    write("coco_results_mine.json", "[]");
    write("coco_results_somebodys.json", "[]");
    assert!(score(out.path(), "0.5").output().unwrap().status.success());
    let names = names(out.path());
    assert!(!names.contains(&"coco_results_mine.json".to_owned()));
    assert!(names.contains(&"coco_results_somebodys.json".to_owned()));
}

/// A session, and a folder for the report, from somebody else: names that this program chose are links to the user's files.
#[test]
fn files_whose_names_the_program_chose_go_through_no_link() {
    let folder = tempfile::tempdir().unwrap();
    let (out, victim) = (folder.path().join("out"), folder.path().join("victim"));
    std::fs::create_dir(&out).unwrap();
    std::fs::write(&victim, "mine").unwrap();
    for name in ["report.html", "summary.json"] {
        symlink(&victim, out.join(name)).unwrap();
    }
    assert!(score(&out, "0.5").output().unwrap().status.success());
    assert_eq!(std::fs::read(&victim).unwrap(), b"mine");
    assert!(!out.join("report.html").is_symlink());
}

/// The files of a killed run are not laid over what came after it.
#[test]
#[cfg(target_os = "linux")]
fn what_is_newer_than_a_killed_run_stays() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    assert!(score(&out, "0.5").output().unwrap().status.success());
    let mut killed = score(&out, "0.25");
    kill_at(&mut killed, folder.path(), 3);
    assert_eq!(killed.output().unwrap().status.code(), None);
    std::thread::sleep(Duration::from_millis(20));
    std::fs::write(out.join("report.html"), "newer").unwrap();
    assert!(run(COMMANDS[1], &out.join("p.png")).status.success());
    assert_eq!(std::fs::read(out.join("report.html")).unwrap(), b"newer");
    assert_eq!(read_json(&out.join("summary.json"))["hit_confidence"], 0.25);
}

/// Runs into one folder at once: in the end all files are of one of them, and nothing else stays.
#[test]
fn of_runs_that_end_at_once_in_one_folder_one_wins_whole() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let alone = ["0.5", "0.25"].map(|confidence| {
        let alone = folder.path().join(confidence);
        assert!(score(&alone, confidence).output().unwrap().status.success());
        alone
    });
    for _ in 0..4 {
        let together = ["0.5", "0.25", "0.5", "0.25"].map(|confidence| {
            let mut run = score(&out, confidence);
            run.stdout(std::process::Stdio::null())
                .stderr(std::process::Stdio::null());
            run.spawn().unwrap()
        });
        for mut run in together {
            assert!(run.wait().unwrap().success());
        }
        let same = |alone: &Path, name: &str| {
            std::fs::read(out.join(name)).unwrap() == std::fs::read(alone.join(name)).unwrap()
        };
        let winner = alone.iter().find(|alone| same(alone, "summary.json")).unwrap();
        assert_eq!(names(&out), names(winner));
        assert!(
            names(winner).iter().all(|name| same(winner, name)),
            "the files are of different runs"
        );
    }
}

/// One folder by several names: its lock is not waited for twice.
#[test]
fn files_of_one_command_may_spell_their_folder_differently() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("out")).unwrap();
    symlink("out", folder.path().join("link")).unwrap();
    for definition in ["./out/board.toml", "link/board.toml", "out/../out/board.toml"] {
        let mut board = program();
        let arguments = "print board --type chessboard --squares 7x5 --square-mm 20 -o out/board.pdf --definition";
        board
            .args(arguments.split_whitespace())
            .arg(definition)
            .current_dir(folder.path());
        let ended = bounded::run(&mut board);
        assert!(ended.output.status.success(), "{}", stderr(&ended.output));
        assert_eq!(names(&folder.path().join("out")), ["board.pdf", "board.toml"]);
    }
}
