//! What tests of the program and of several crates need: paths, the program, networks, films, rendered photos, and bad input made from good.

pub mod films;
pub mod kills;
pub mod onnx;
pub mod rendered;
pub mod served;
mod stored;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

pub use scaleproof_core::files::environment::variable;
pub use stored::{skyline, stored};

/// What takes longer hangs. It ends a test, and judges no speed: a machine may be busy.
pub const HANG: Duration = Duration::from_secs(600);

/// The project's folder.
pub fn home() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// Writes a shell script that is run as a program.
pub fn write_program(path: &Path, script: &str) {
    std::fs::write(path, format!("#!/bin/sh\n{script}\n")).unwrap();
    std::fs::set_permissions(path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
}

/// The files below a folder with their bytes; links to folders are not followed.
pub fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() && !path.is_symlink() {
            true => found.extend(contents(&path)),
            false if path.is_dir() => {}
            false => _ = found.insert(path.clone(), std::fs::read(&path).unwrap()),
        }
    }
    found
}

/// A file of the shared material. Tests that call it are ignored unless `./run test --shared` asks for them; a missing file fails them.
pub fn shared(path: &str) -> PathBuf {
    let root = variable("SCALEPROOF_SHARED").expect(
        "this test needs the shared material: mark it as ignored for that reason, and run ./run test --shared with SCALEPROOF_SHARED set",
    );
    let file = Path::new(&root).join(path);
    assert!(file.exists(), "the shared material lacks {}", file.display());
    file
}

/// The number that an environment variable holds.
pub fn number<T: std::str::FromStr>(variable: &str) -> Option<T> {
    let text = self::variable(variable)?.into_string().unwrap();
    Some(
        text.parse()
            .unwrap_or_else(|_| panic!("{variable} is no such number: {text}")),
    )
}

/// Where cargo has built the program: above the folder of this test program.
pub fn built() -> PathBuf {
    let tests = std::env::current_exe().unwrap();
    tests.ancestors().nth(2).unwrap().join("scaleproof")
}

/// A folder that outlives the tests, for what is large and made once.
pub fn kept(name: &str) -> PathBuf {
    home().join("target/tmp").join(name)
}

/// The program, without the weights that this machine may have.
pub fn program() -> Command {
    let mut command = Command::new(built());
    command
        .env_remove("SCALEPROOF_SHARED")
        .env_remove("SCALEPROOF_DETECTORS");
    command.env("XDG_CACHE_HOME", home().join("target/empty-cache"));
    command
}

/// What the program answers to some arguments.
pub fn run(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

/// A path as an argument.
pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Writes a file into a folder, and gives its path.
pub fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

/// The faces of a box, counter-clockwise seen from outside: −x, +x, −y, +y, −z, +z. Corner i has the upper end of axis k where bit k of i is set.
pub const BOX_FACES: [[usize; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Bad input: exit code 2, and one sentence on standard error that contains every one of `words`.
pub fn assert_refused(output: &Output, words: &[&str]) {
    let text = stderr(output);
    assert_eq!(output.status.code(), Some(2), "exit code; standard error: {text}");
    // On a slow machine, progress stands before it.
    let is_refusal = |line: &&str| ["error: ", "no pose for "].iter().any(|start| line.starts_with(start));
    // A hint may stand below it.
    let is_hint = |line: &&str| line.starts_with("hint: ");
    let last = text.lines().rfind(|line| !is_hint(line));
    let is_last = last.as_ref().is_some_and(is_refusal);
    assert!(
        is_last && text.lines().filter(is_refusal).count() == 1,
        "one sentence, not: {text}"
    );
    for word in words {
        assert!(text.contains(word), "`{word}` is not in: {text}");
    }
}

/// A copy of [`skyline`] that a test may break.
pub fn copy_of_skyline() -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(skyline()).unwrap() {
        let path = entry.unwrap().path();
        if path.is_file() {
            std::fs::copy(&path, copy.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let recorded = copy.path().join("recorded");
    std::fs::create_dir(&recorded).unwrap();
    for entry in std::fs::read_dir(skyline().join("recorded")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, recorded.join(path.file_name().unwrap())).unwrap();
    }
    copy
}

/// A binary glTF of its JSON text and its data (glTF 2.0, 4.4: two chunks of whole words).
pub fn glb(mut json: Vec<u8>, mut data: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    data.resize(data.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + data.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// A JPEG with an EXIF block that says nothing but the orientation (Exif 2.32, 4.6).
pub fn oriented(jpeg: &[u8], orientation: u8) -> Vec<u8> {
    let block = [
        &b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..],
        &[orientation, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    let length = (block.len() as u16 + 2).to_be_bytes();
    [&jpeg[..2], &[0xFF, 0xE1], &length, &block, &jpeg[2..]].concat()
}

/// A photo in two tinted JPEGs that store the same luma and other colours: what is measured on luma is the same in both. The chroma's
/// quantisation table (ITU-T T.81, B.2.4.1: table 1) is multiplied in the second.
pub fn tinted_twice(photo: &Path) -> [Vec<u8>; 2] {
    let mut rgb = image::open(photo).unwrap().to_rgb8();
    for (x, y, pixel) in rgb.enumerate_pixels_mut() {
        let tint = [(x / 40) % 3, (x / 40 + y / 40) % 3, (y / 40) % 3];
        for (value, tint) in pixel.0.iter_mut().zip(tint) {
            *value = (f64::from(*value) * [1.0, 0.8, 0.65][tint as usize]) as u8;
        }
    }
    let mut first = Vec::new();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut first, 95);
    rgb.write_with_encoder(encoder).unwrap();
    let (mut second, mut at) = (first.clone(), 2);
    while first[at + 1] != 0xDA {
        let end = at + 2 + usize::from(u16::from_be_bytes([first[at + 2], first[at + 3]]));
        if first[at + 1] == 0xDB {
            let tables = second[at + 4..end].chunks_exact_mut(65).filter(|table| table[0] == 1);
            tables.for_each(|table| table[1..].iter_mut().for_each(|v| *v = v.saturating_mul(3)));
        }
        at = end;
    }
    assert!(first != second);
    [first, second]
}

pub fn read_json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Headless Chromium with a fresh profile, until it ends.
pub fn chromium(arguments: &[String]) -> Output {
    let profile = tempfile::tempdir().unwrap();
    with_chromium(profile.path(), |command| command.args(arguments).output())
}

/// Headless Chromium with a profile, started by `start`; a missing browser fails the test with what to do.
pub fn with_chromium<T>(profile: &Path, start: impl Fn(&mut Command) -> std::io::Result<T>) -> T {
    let named = variable("CHROMIUM").and_then(|name| name.into_string().ok());
    let candidates = named
        .into_iter()
        .chain(["chromium", "chromium-browser", "google-chrome"].map(String::from));
    for program in candidates {
        let mut command = Command::new(&program);
        command
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--hide-scrollbars",
            ])
            .arg(format!("--user-data-dir={}", profile.display()));
        if let Ok(started) = start(&mut command) {
            return started;
        }
    }
    panic!("no Chromium found: run the tests through ./run test, which installs it, or set CHROMIUM");
}

/// The pages of a PDF as pdftoppm renders them, in order; `read` makes what is kept of each PPM or PGM file's bytes.
pub fn pictured<T>(pdf: &Path, arguments: &[&str], read: impl Fn(&[u8]) -> T) -> Vec<T> {
    let folder = tempfile::tempdir().unwrap();
    let run = Command::new("pdftoppm")
        .args(arguments)
        .arg(pdf)
        .arg(folder.path().join("page"))
        .status();
    let status = run.expect("this test renders the PDF with pdftoppm: install poppler-utils");
    assert!(status.success(), "pdftoppm failed on {}", pdf.display());
    let entries = std::fs::read_dir(folder.path()).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.iter().map(|path| read(&std::fs::read(path).unwrap())).collect()
}
