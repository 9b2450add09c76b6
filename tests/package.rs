//! The archive, up to its packing: does the folder run by itself, and is everything in it that belongs there?
//!
//! Whether it runs on bare systems is tried by hand (`docs/lessons/building.md`); here it runs with nothing but the C library from outside.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

use crate::common;

use std::path::Path;
use std::process::Command;

use common::{home, stderr, stdout};

/// What every Linux with this libc has.
const LIBC: [&str; 8] = [
    "linux-vdso.so",
    "ld-linux-x86-64.so",
    "libc.so",
    "libm.so",
    "libdl.so",
    "libpthread.so",
    "librt.so",
    "libresolv.so",
];

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn the_packed_folder_runs_by_itself_and_says_whose_everything_is() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("scaleproof");
    let made = Command::new(home().join(".ci/package.sh"))
        .arg("--folder")
        .arg(&folder)
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", stderr(&made));

    // Every library comes from the folder.
    let linked = Command::new("ldd").arg(folder.join("scaleproof")).output().unwrap();
    let mut own = 0;
    for line in stdout(&linked).lines() {
        let name = line.split_whitespace().next().unwrap();
        let is_libc = LIBC
            .iter()
            .any(|known| name.rsplit('/').next().unwrap().starts_with(known));
        assert!(
            is_libc || line.contains(&format!("{}/lib/", folder.display())),
            "{line}"
        );
        own += usize::from(!is_libc);
    }
    assert!(own > 10, "{own} libraries");

    // The demo, where nothing is installed and nothing is set.
    let empty = tempfile::tempdir().unwrap();
    let demo = Command::new(folder.join("scaleproof"))
        .env_clear()
        .env("HOME", empty.path())
        .current_dir(empty.path())
        .args(["demo", "-o", "out"])
        .output()
        .unwrap();
    assert!(demo.status.success(), "{}", stderr(&demo));
    assert!(stdout(&demo).contains("0.58 → 0.37  6 → 4 of 8"), "{}", stdout(&demo));
    assert!(empty.path().join("out/report.html").is_file() && empty.path().join("out/template.pdf").is_file());
    // ONNX Runtime is found beside the program: a file that is no network is refused by it, and not for want of it.
    std::fs::write(empty.path().join("x.onnx"), "no network").unwrap();
    let added = Command::new(folder.join("scaleproof"))
        .env_clear()
        .env("HOME", empty.path())
        .current_dir(empty.path())
        .args(["detectors", "add", "x.onnx"])
        .output()
        .unwrap();
    assert_eq!(added.status.code(), Some(2));
    assert!(!stderr(&added).contains("libonnxruntime"), "{}", stderr(&added));

    let pages = names(&folder.join("man/man1"));
    for page in [
        "scaleproof.1",
        "scaleproof-score.1",
        "scaleproof-print-template.1",
        "scaleproof-attack-run.1",
    ] {
        assert!(pages.iter().any(|name| name == page), "{page} is not among {pages:?}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let script = std::fs::read_to_string(folder.join(format!("completions/scaleproof.{shell}"))).unwrap();
        assert!(script.contains("scaleproof"), "{shell}");
    }

    let licences = names(&folder.join("licences"));
    let crates = std::fs::read_to_string(folder.join("licences/crates.txt")).unwrap();
    let mut without_text = Vec::new();
    for line in crates.lines() {
        let (what, licence) = line.split_once(" | ").unwrap();
        let name = what.split_whitespace().next().unwrap();
        let prefix = format!("crate-{name}-");
        if !licences.iter().any(|file| file.starts_with(&prefix)) {
            assert!(
                !licence.trim().is_empty(),
                "{what} has neither a text nor the name of a licence"
            );
            without_text.push(name);
        }
    }
    // Some crates are published without the text; the name of their licence is there.
    assert!(without_text.len() * 5 < crates.lines().count(), "{without_text:?}");
    for file in [
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "onnxruntime-LICENSE",
        "onnxruntime-ThirdPartyNotices.txt",
    ] {
        assert!(licences.iter().any(|name| name == file), "{file}");
    }
    assert!(
        licences.iter().any(|name| name.starts_with("libopencv-core")),
        "{licences:?}"
    );
}
