//! `./run test` with a cargo that fails on purpose: everything is run, and the end says what failed.

use std::path::Path;
use std::process::{Command, Output};

use crate::common::{home, stderr, write_program};

/// A stand-in for cargo, by a script that is given its subcommand.
fn with_cargo(folder: &Path, script: &str) -> Output {
    let called = folder.join("called");
    write_program(
        &folder.join("cargo"),
        &format!("echo \"$1\" >> '{}'\ncase \"$1\" in\n{script}\nesac", called.display()),
    );
    let path = format!("{}:{}", folder.display(), std::env::var("PATH").unwrap());
    Command::new("bash")
        .arg(home().join("run"))
        .arg("test")
        .env("PATH", path)
        .output()
        .unwrap()
}

#[test]
fn a_red_part_hides_no_other_and_the_end_says_what_failed_and_what_was_slow() {
    let folder = tempfile::tempdir().unwrap();
    let script = r#"fmt) [ "$2" = --version ] ;;
doc) exit 101 ;;
test) case "$*" in *--no-run*) exit ;; *--doc*) exit 101 ;; esac
cat <<'SAID'
     Running tests/program.rs (target/release/deps/program-1)
running 3 tests
test score::a ... ok <0.900s>
test score::b ... FAILED <31.250s>
test score::c ... ignored, needs the shared material
test result: FAILED. 1 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 31.26s
     Running tests/pose.rs (target/release/deps/pose-1)
running 4000 tests
SAID
for number in $(seq 4000); do echo "test photos::one_of_more_than_fits_in_a_pipe_$number ... ok <0.001s>"; done
cat <<'SAID'
test result: ok. 4000 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 4.00s
     Running tests/rig.rs (target/release/deps/rig-1)
running 4 tests
test d ... ok <4.000s>
error: test failed, to rerun pass `-p scaleproof-rig --test rig`
SAID
exit 101 ;;"#;
    let ended = with_cargo(folder.path(), script);
    let said = stderr(&ended);
    assert_eq!(ended.status.code(), Some(1), "{said}");
    let called = std::fs::read_to_string(folder.path().join("called")).unwrap();
    assert_eq!(
        called.split_whitespace().collect::<Vec<_>>(),
        [
            "fmt", "clippy", "fmt", "clippy", "clippy", "doc", "test", "test", "test"
        ]
    );
    let slow = &said[said.find("the slowest parts").unwrap_or_else(|| panic!("{said}"))..];
    let (parts, tests) = slow.split_once("the slowest tests").unwrap();
    assert!(parts.contains("31.3  tests/program.rs\n"), "{parts}");
    let tests: Vec<&str> = tests.lines().skip(1).take(3).map(str::trim).collect();
    assert_eq!(
        tests,
        [
            "31.2  tests/program.rs: score::b",
            "4.0  tests/rig.rs: d",
            "0.9  tests/program.rs: score::a"
        ]
    );
    let end = &said[said.find("RED: ").unwrap_or_else(|| panic!("{said}"))..];
    for part in [
        "RED: format",
        "RED: documentation",
        "RED: tests",
        "RED: examples of the documentation",
        "tests/program.rs: score::b",
        "tests/rig.rs ended early: 3 of its tests",
    ] {
        assert!(end.contains(part), "no {part:?} in: {end}");
    }
    assert!(!end.contains("lints") && !end.contains("score::a"), "{end}");
}

#[test]
fn tests_that_do_not_build_are_said_not_to_have_run() {
    let folder = tempfile::tempdir().unwrap();
    let ended = with_cargo(
        folder.path(),
        "test) echo 'error: could not compile `scaleproof` (lib)'; exit 101 ;;",
    );
    assert_eq!(ended.status.code(), Some(1));
    assert!(
        stderr(&ended).contains("they could not be built: none was run"),
        "{}",
        stderr(&ended)
    );
}
