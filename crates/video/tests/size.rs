//! A video whose frames change their size within it.

use std::path::Path;
use std::process::Command;

use scaleproof_video::{Selection, Video};

/// A second of ten frames.
fn clip(folder: &Path, size: &str) -> Vec<u8> {
    let path = folder.join(format!("{size}.ts"));
    let source = format!("testsrc=size={size}:rate=10:duration=1");
    let made = Command::new("ffmpeg")
        .args([
            "-v", "error", "-f", "lavfi", "-i", &source, "-c:v", "libx264", "-f", "mpegts",
        ])
        .arg(&path)
        .status();
    assert!(made.expect("ffmpeg is installed").success());
    std::fs::read(path).unwrap()
}

/// ffmpeg stretches later frames to the size of the first, which no camera file fits.
#[test]
fn frames_of_another_size_are_not_taken_for_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let (path, [large, small]) = (
        folder.path().join("both.ts"),
        ["320x240", "160x128"].map(|size| clip(folder.path(), size)),
    );
    std::fs::write(&path, [large, small].concat()).unwrap();
    let frames: Vec<_> = Video::open(&path)
        .unwrap()
        .luma(&Selection::default())
        .unwrap()
        .collect();
    let (last, before) = frames.split_last().unwrap();
    assert!(
        before.len() == 10 && before.iter().all(Result::is_ok),
        "{}",
        before.len()
    );
    let sentence = last.as_ref().unwrap_err().to_string();
    assert!(sentence.contains("its frames change their size"), "{sentence}");
}
