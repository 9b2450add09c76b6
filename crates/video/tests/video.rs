//! The crate's tests. Videos are made by ffmpeg's encoders, and what is in them is known from the filter that drew them.

use std::path::{Path, PathBuf};
use std::process::Command;

use scaleproof_video::{Selection, Video};

/// A video of two seconds whose frames get lighter by 4 grey levels each, with an encoder's options.
fn made(folder: &Path, name: &str, options: &[&str]) -> PathBuf {
    let path = folder.join(name);
    let source = "color=c=black:s=320x180:r=25:d=2,format=yuv420p,geq=lum='16+4*N':cb=128:cr=128";
    let done = Command::new("ffmpeg")
        .args(["-v", "error", "-f", "lavfi", "-i", source])
        .args(options)
        .arg(&path)
        .status();
    assert!(done.unwrap().success(), "{name}");
    path
}

#[test]
fn frames_come_with_their_numbers_and_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = made(folder.path(), "grey.mp4", &["-c:v", "libx264", "-crf", "10"]);
    let video = Video::open(&path).unwrap();
    assert_eq!(
        [video.width, video.height, video.turned_deg, video.bits],
        [320, 180, 0, 8]
    );
    assert_eq!((video.codec.as_str(), video.frames), ("h264", Some(50)));
    let frames: Vec<_> = video.luma(&Selection::default()).unwrap().map(Result::unwrap).collect();
    assert_eq!(frames.len(), 50);
    for (i, frame) in frames.iter().enumerate() {
        assert_eq!(frame.number, i as u64);
        assert!((frame.time_s - i as f64 / 25.0).abs() < 1e-9);
        let level = f64::from(frame.image.get_pixel(160, 90).0[0]);
        // From 16 … 235 to 0 … 255.
        let expected = 4.0 * i as f64 * 255.0 / 219.0;
        assert!((level - expected).abs() < 3.0, "frame {i}: {level}, not {expected}");
    }
}
