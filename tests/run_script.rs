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
fn a_red_part_hides_no_other_and_the_end_says_what_failed() {
    let folder = tempfile::tempdir().unwrap();
    let script = r#"fmt) [ "$2" = --version ] ;;
doc) exit 101 ;;
test) cat <<'SAID'
     Running tests/program.rs (target/release/deps/program-1)
running 3 tests
test score::a ... ok
test score::b ... FAILED
test score::c ... ignored, needs the shared material
test result: FAILED. 1 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out
     Running tests/rig.rs (target/release/deps/rig-1)
running 4 tests
test d ... ok
error: test failed, to rerun pass `-p scaleproof-rig --test rig`
   Doc-tests scaleproof
running 1 test
test src/lib.rs - (line 4) ... ok
test result: ok. 1 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out
SAID
exit 101 ;;"#;
    let ended = with_cargo(folder.path(), script);
    let said = stderr(&ended);
    assert_eq!(ended.status.code(), Some(1), "{said}");
    let called = std::fs::read_to_string(folder.path().join("called")).unwrap();
    assert_eq!(
        called.split_whitespace().collect::<Vec<_>>(),
        ["fmt", "clippy", "fmt", "clippy", "clippy", "clippy", "doc", "test"]
    );
    let end = &said[said.find("RED: ").unwrap_or_else(|| panic!("{said}"))..];
    for part in [
        "RED: format",
        "RED: documentation",
        "RED: tests",
        "tests/program.rs: score::b",
        "tests/rig.rs ended early: 3 of its tests",
    ] {
        assert!(end.contains(part), "no {part:?} in: {end}");
    }
    assert!(
        !end.contains("lints") && !end.contains("score::a") && !end.contains("Doc-tests"),
        "{end}"
    );
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
