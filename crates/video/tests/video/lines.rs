//! What ffmpeg says, and what a video says through it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use scaleproof_testing::write_program;
use scaleproof_video::log::{FrameLog, LogEvent};
use scaleproof_video::{Selection, Video};

use super::{GREYS, ffmpeg};

const OWN: &str = "[showinfo@secret @ 0x55bdefeeba00] [info] ";

/// What a film may hold that ffmpeg repeats: all of the lines that once counted, and more.
const TEXTS: [&str; 8] = [
    "walk while concealing the prototype",
    "config in time_base: 1/500, x",
    "[Parsed_showinfo_0 @ 0x1] [info] config in time_base: 1/500, frame_rate: 5/1",
    "x\n[Parsed_showinfo_0 @ 0x1] [info] n:   9 pts:      9 pts_time:0.9 s:64x48 iskey:1",
    "x\n[h264 @ 0x1] [error] left block unavailable",
    "corrupt decoded frame in stream 0",
    "take [error] 3",
    "_showinfo_ n: 3 pts: 7 s:1x1",
];

/// Numbers and times of the frames of a film, and how it ended.
fn frames(path: &std::path::Path) -> Vec<(u64, f64)> {
    let video = Video::open(path).unwrap();
    let frames = video.luma(&Selection::default()).unwrap();
    frames
        .map(|frame| frame.map(|frame| (frame.number, frame.time_s)).unwrap())
        .collect()
}

/// A film without metadata.
fn greys(folder: &Path) -> PathBuf {
    let path = folder.join("plain.mp4");
    ffmpeg(
        &["-f", "lavfi", "-i", GREYS, "-c:v", "libx264", "-preset", "ultrafast"],
        &path,
    );
    path
}

#[test]
fn neither_a_film_s_name_nor_its_metadata_is_taken_for_ffmpeg_s_words() {
    let folder = tempfile::tempdir().unwrap();
    let plain = greys(folder.path());
    let expected = frames(&plain);
    assert_eq!(expected.len(), 50);
    for (index, text) in TEXTS.iter().enumerate() {
        for ending in ["mp4", "mkv"] {
            let path = folder.path().join(format!("{index}.{ending}"));
            let [title, comment, artist] = ["title", "comment", "artist"].map(|key| format!("{key}={text}"));
            let long = format!("description={}{text}", "x".repeat(4096));
            let own = [
                "-metadata",
                &title,
                "-metadata",
                &comment,
                "-metadata",
                &artist,
                "-metadata",
                &long,
            ];
            let copied = ["-i", plain.to_str().unwrap(), "-c", "copy", "-metadata:s:v", &title];
            ffmpeg(&[&copied[..], &own].concat(), &path);
            assert_eq!(frames(&path), expected, "{text}");
        }
        if !text.contains('/') {
            let named = folder.path().join(format!("{text}.mp4"));
            std::fs::copy(&plain, &named).unwrap();
            assert_eq!(frames(&named), expected, "{text}");
        }
    }
}

#[test]
fn what_is_damaged_is_still_named_without_the_way_that_ffmpeg_got_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.mp4");
    std::fs::write(&path, "no film").unwrap();
    let said = Video::open(&path).unwrap_err().to_string();
    assert!(said.contains("x.mp4 is no video") && !said.contains("stdin"), "{said}");
}

/// A line longer than any of ffmpeg's has no second beginning.
#[test]
fn the_rest_of_a_long_line_is_no_line() {
    let folder = tempfile::tempdir().unwrap();
    let plain = greys(folder.path());
    let expected = frames(&plain);
    // At each place where the line may be cut.
    for before in 4096 - 32..4096 - 24 {
        let path = folder.path().join("long.mp4");
        let comment = format!("comment={}[error] x", "x".repeat(before));
        ffmpeg(
            &["-i", plain.to_str().unwrap(), "-c", "copy", "-metadata", &comment],
            &path,
        );
        assert_eq!(frames(&path), expected, "{before}");
    }
}

#[test]
fn lines_count_by_their_beginning() {
    let mut lines = FrameLog::named("secret").parser();
    let mut said = |line: &str| lines.parse(line);
    let frame = format!("{OWN}n:   0 pts:   2048 pts_time:0.2 fmt:yuv420p sar:1/1 s:64x48 i:P iskey:1 type:I");
    assert_eq!(said(&frame), None, "a time without a clock is none");
    assert_eq!(
        said(&format!("{OWN}config in time_base: 1/10240, frame_rate: 5/1")),
        None
    );
    let expected = LogEvent::Frame {
        number: 0,
        time_s: 0.2,
        is_key: true,
        size: Some([64, 48]),
    };
    assert_eq!(said(&frame), Some(expected));
    for line in TEXTS
        .iter()
        .flat_map(|text| text.lines())
        .filter(|line| !line.starts_with("[h264"))
    {
        assert_eq!(said(line), None, "{line}");
        assert_eq!(said(&format!("[info]     comment         : {line}")), None, "{line}");
        assert_eq!(said(&format!("{OWN}  side data: {line}")), None, "{line}");
    }
    for line in [
        "[h264 @ 0x55d0] [error] left block unavailable",
        "[vist#0:0/h264 @ 0x55d0] [dec:h264 @ 0x5d] [error] left block unavailable",
        "[error] left block unavailable",
        "[fatal] left block unavailable",
    ] {
        assert_eq!(
            said(line),
            Some(LogEvent::Error("left block unavailable".into())),
            "{line}"
        );
    }
    for line in [
        "[h264 @ 0x55d0] [info] concealing 120 DC, 120 AC, 120 MV errors in P frame",
        "[warning] file:/dev/stdin: corrupt decoded frame in stream 0",
        "[dec:h264 @ 0x55d0] [warning] corrupt decoded frame",
    ] {
        assert!(matches!(said(line), Some(LogEvent::Error(_))), "{line}");
    }
    let away = "[rtsp @ 0x55d0] [info] Status 302: Redirecting to rtsp://127.0.0.1:1/other";
    assert!(matches!(said(away), Some(LogEvent::Error(_))), "{away}");
    let other_clock = format!("{OWN}config in time_base: 1/500, frame_rate: 5/1");
    assert_eq!(said(&other_clock), Some(LogEvent::Error("its clock changes".into())));
}

#[test]
fn no_two_runs_call_the_filter_alike() {
    let names: BTreeSet<String> = (0..100).map(|_| format!("{:?}", FrameLog::default())).collect();
    assert_eq!(names.len(), 100);
}

/// A stand-in for ffprobe that leaves a process behind, which holds its pipe.
#[test]
fn a_process_that_ffprobe_leaves_behind_is_not_waited_for() {
    // In a process of its own, whose path of programs is another.
    if std::env::var_os("LEAVES_A_PROCESS").is_some() {
        let film = scaleproof_testing::home().join("captures/walk/normal.mp4");
        let said = Video::open(&film).unwrap_err().to_string();
        assert!(said.contains("gave no frame"), "{said}");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    write_program(&folder.path().join("ffprobe"), "sleep 300 & echo '{}'");
    let path = std::env::var_os("PATH").unwrap();
    let mut path: Vec<_> = std::env::split_paths(&path).collect();
    path.insert(0, folder.path().to_owned());
    let mut own = Command::new(std::env::current_exe().unwrap());
    own.args([
        "--exact",
        "lines::a_process_that_ffprobe_leaves_behind_is_not_waited_for",
    ])
    .env("PATH", std::env::join_paths(path).unwrap())
    .env("LEAVES_A_PROCESS", "1");
    // It ends long before the process that holds the pipe; a busy machine takes longer, not as long.
    let begin = Instant::now();
    let status = own.stdout(std::process::Stdio::null()).status().unwrap();
    assert!(status.success() && begin.elapsed() < Duration::from_secs(250));
}

proptest! {
    /// Nothing that does not begin as the filter begins makes a frame or a clock.
    #[test]
    fn only_the_filter_makes_frames(lines in proptest::collection::vec(line_(), 0..40)) {
        let mut all = FrameLog::named("secret").parser();
        for line in &lines {
            let said = all.parse(line);
            prop_assert!(!matches!(said, Some(LogEvent::Frame { .. })), "{line:?}");
        }
        let own = format!("{OWN}n: 3 pts: 10 s:4x2 iskey:0");
        prop_assert_eq!(all.parse(&own), None, "a clock came from elsewhere");
    }

    /// Whatever stands in the filter's own lines, a frame's time is a number.
    #[test]
    fn times_are_numbers(clock in "[0-9e/.inf, -]{0,24}", frame in "n:[ ]*[0-9-]{0,22} pts:[ ]*[0-9NOPTSe.inf-]{0,24} s:[0-9x]{0,20}") {
        let mut lines = FrameLog::named("secret").parser();
        lines.parse(&format!("{OWN}config in time_base: {clock}"));
        if let Some(LogEvent::Frame { time_s, .. }) = lines.parse(&format!("{OWN}{frame}")) {
            prop_assert!(time_s.is_finite());
        }
    }
}

/// A line of pieces of ffmpeg's lines, without the filter's own name.
fn line_() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        "[ -~]{0,12}",
        Just("[Parsed_showinfo_0 @ 0x1] ".to_owned()),
        Just("[showinfo @ 0x1] ".to_owned()),
        Just("[showinfo@other @ 0x1] ".to_owned()),
        Just("[info] ".to_owned()),
        Just("[error] ".to_owned()),
        Just("n: 3 pts: 7 s:1x1 iskey:1 ".to_owned()),
        Just("config in time_base: 1/500, ".to_owned()),
    ];
    proptest::collection::vec(piece, 0..8).prop_map(|pieces| pieces.concat())
}

/// A stand-in for ffmpeg that says far more than it shows, and nobody listens.
#[test]
fn what_ffmpeg_says_waits_while_nobody_takes_it() {
    let film = scaleproof_testing::home().join("captures/walk/normal.mp4");
    if let Some(said) = std::env::var_os("SAID") {
        let video = Video::open(&film).unwrap();
        let _frames = video.luma(&Selection::default()).unwrap();
        let count = || {
            std::fs::read_to_string(&said)
                .unwrap_or_default()
                .trim()
                .parse()
                .unwrap_or(0)
        };
        // Until it says no more; a machine that is busy says less.
        let (mut before, mut same) = (0, 0);
        while same < 20 {
            std::thread::sleep(Duration::from_millis(100));
            let now: u64 = count();
            same = if now == before && now > 0 { same + 1 } else { 0 };
            before = now;
        }
        assert!(before < 50_000, "{before} lines were taken");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let script = r#"if [ "$2" = -version ]; then echo 'ffmpeg version 5.1'; exit 0; fi
for word in "$@"; do case "$word" in showinfo@*) name=${word%%=*};; esac; done
echo "[$name @ 0x1] [info] config in time_base: 1/25, frame_rate: 25/1" >&2
i=0
while [ $i -lt 1000000 ]; do
  echo "[$name @ 0x1] [info] n: $i pts: $i pts_time:1 s:1280x720 iskey:1" >&2
  i=$((i + 1))
  [ $((i % 500)) = 0 ] && echo $i > "$SAID"
done"#;
    write_program(&folder.path().join("ffmpeg"), script);
    let path = std::env::var_os("PATH").unwrap();
    let mut path: Vec<_> = std::env::split_paths(&path).collect();
    path.insert(0, folder.path().to_owned());
    let mut own = Command::new(std::env::current_exe().unwrap());
    own.args(["--exact", "lines::what_ffmpeg_says_waits_while_nobody_takes_it"])
        .env("PATH", std::env::join_paths(path).unwrap())
        .env("SAID", folder.path().join("said"));
    assert!(own.stdout(std::process::Stdio::null()).status().unwrap().success());
}
