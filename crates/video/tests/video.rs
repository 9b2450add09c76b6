//! The crate's tests. Videos are made by ffmpeg's encoders, and what is in them is known from the filter that drew them.

#[path = "video/lines.rs"]
mod lines;

use std::path::{Path, PathBuf};
use std::process::Command;

use scaleproof_core::files::sha256_hex;
use scaleproof_photo::Luma as _;
use scaleproof_testing::{films::turn, home};
use scaleproof_video::{Frames, Picture, Pixels, Range, Selection, Video, VideoError};
use tempfile::TempDir;

/// Two seconds at 25 frames a second; the n-th frame has the luma 16 + 4 n, and its left half is 40 levels lighter.
const GREYS: &str = "color=c=black:s=320x180:r=25:d=2,format=yuv420p,geq=lum='16+4*N*0.8+40*lt(X,160)':cb=128:cr=128";

fn ffmpeg(arguments: &[&str], path: &Path) {
    let done = Command::new("ffmpeg")
        .args(["-v", "error", "-y"])
        .args(arguments)
        .arg(path)
        .status();
    assert!(done.unwrap().success(), "{}", path.display());
}

/// A video of [`GREYS`], with an encoder's options.
fn made(folder: &TempDir, name: &str, options: &[&str]) -> PathBuf {
    let path = folder.path().join(name);
    ffmpeg(&[&["-f", "lavfi", "-i", GREYS], options].concat(), &path);
    path
}

/// The luma of frame `n` right of the middle, from the range 16 … 235 to 0 … 255.
fn level(n: u64) -> f64 {
    3.2 * n as f64 * 255.0 / 219.0
}

fn refusal(path: &Path) -> String {
    let last = |video: Video| {
        video
            .luma(&Selection::default())?
            .find_map(Result::err)
            .map_or(Ok(()), Err)
    };
    let sentence = Video::open(path).and_then(last).unwrap_err().to_string();
    assert!(!sentence.contains('\n') && sentence.len() < 400, "{sentence}");
    sentence
}

#[test]
fn frames_of_every_codec_and_container_come_with_their_numbers_times_and_greys() {
    let folder = tempfile::tempdir().unwrap();
    let made_by: [(&str, &str, u32, &[&str]); 6] = [
        (
            "a.mp4",
            "h264",
            8,
            &["-c:v", "libx264", "-preset", "ultrafast", "-crf", "8"],
        ),
        (
            "b.mov",
            "h264",
            8,
            &["-c:v", "libx264", "-preset", "ultrafast", "-crf", "8", "-bf", "3"],
        ),
        (
            "c.mkv",
            "hevc",
            8,
            &[
                "-c:v",
                "libx265",
                "-preset",
                "ultrafast",
                "-crf",
                "8",
                "-x265-params",
                "log-level=none",
            ],
        ),
        (
            "d.mp4",
            "hevc",
            10,
            &[
                "-c:v",
                "libx265",
                "-preset",
                "ultrafast",
                "-crf",
                "8",
                "-pix_fmt",
                "yuv420p10le",
                "-x265-params",
                "log-level=none",
            ],
        ),
        (
            "e.webm",
            "vp9",
            8,
            &[
                "-c:v",
                "libvpx-vp9",
                "-deadline",
                "realtime",
                "-cpu-used",
                "8",
                "-crf",
                "8",
                "-b:v",
                "0",
            ],
        ),
        (
            "-f: 100%d.webm",
            "av1",
            8,
            &["-c:v", "libsvtav1", "-preset", "12", "-crf", "10"],
        ),
    ];
    for (name, codec, bits, options) in made_by {
        let path = folder.path().join(name);
        // ffmpeg itself takes such a name for a pattern.
        let plain = made(&folder, &format!("made.{}", name.rsplit('.').next().unwrap()), options);
        std::fs::rename(plain, &path).unwrap();
        let video = Video::open(&path).unwrap();
        assert_eq!(
            (video.codec.as_str(), video.bits, video.range),
            (codec, bits, Range::Standard),
            "{name}"
        );
        assert_eq!([video.width, video.height, video.turned_deg], [320, 180, 0]);
        assert!((video.duration_s.unwrap() - 2.0).abs() < 0.1);
        let frames: Vec<_> = video.luma(&Selection::default()).unwrap().map(Result::unwrap).collect();
        assert_eq!(frames.len(), 50, "{name}");
        for (i, frame) in (0..).zip(&frames) {
            // WebM and MKV count milliseconds.
            assert!(
                frame.number == i && (frame.time_s - i as f64 / 25.0).abs() < 6e-4,
                "{name}"
            );
            let found = f64::from(frame.image.get_pixel(240, 90).0[0]);
            assert!(
                (found - level(i)).abs() < 4.0,
                "{name}, frame {i}: {found}, not {}",
                level(i)
            );
        }
        let reduced = Selection {
            height: Some(90),
            numbers: Some(vec![30]),
            ..Selection::default()
        };
        let colours: Vec<_> = video.rgb(&reduced).unwrap().map(Result::unwrap).collect();
        assert_eq!(
            (colours.len(), colours[0].number, colours[0].image.dimensions()),
            (1, 30, (160, 90))
        );
        for channel in colours[0].image.get_pixel(120, 45).0 {
            assert!((f64::from(channel) - level(30)).abs() < 4.0, "{name}: {channel}");
        }
    }
}

/// Bytes that are known, encoded without loss: the same luma, whatever the version of ffmpeg makes of the range of grey; reduced, too.
#[test]
fn luma_is_that_which_is_stored() {
    let (folder, size) = (tempfile::tempdir().unwrap(), [512, 64]);
    let [raw, film] = ["stored.yuv", "stored.mp4"].map(|name| folder.path().join(name));
    let stored: Vec<u8> = (0..size[1] * size[0]).map(|i| (i / 2 % 256) as u8).collect();
    std::fs::write(&raw, [&stored[..], &vec![128; stored.len() / 2]].concat()).unwrap();
    let source = [
        "-f",
        "rawvideo",
        "-pixel_format",
        "yuv420p",
        "-video_size",
        "512x64",
        "-i",
        raw.to_str().unwrap(),
    ];
    ffmpeg(&[&source[..], &["-c:v", "libx264", "-qp", "0"]].concat(), &film);
    let video = Video::open(&film).unwrap();
    let wide = |level: f64| (255.0 / 219.0 * (level - 16.0)).clamp(0.0, 255.0);
    let luma = |height| {
        let selection = Selection {
            height,
            ..Selection::default()
        };
        video.luma(&selection).unwrap().next().unwrap().unwrap().image
    };
    let whole = luma(None);
    assert_eq!((whole.width(), whole.height()), (size[0], size[1]));
    for (found, stored) in whole.iter().zip(&stored) {
        assert_eq!(*found, wide(f64::from(*stored)).round() as u8, "stored as {stored}");
    }
    // Two of a row are alike, and so are all rows.
    for (found, stored) in luma(Some(32)).iter().zip(0..=255) {
        assert!(
            (f64::from(*found) - wide(f64::from(stored))).abs() <= 1.0,
            "stored as {stored}: {found}"
        );
    }
}

/// Luma, also reduced, and colours of a stored film, as ffmpeg 5.1, 7.1 and 9.0 give them, to the bit.
#[test]
fn frames_do_not_depend_on_the_version_of_ffmpeg() {
    fn bytes<P: Pixels>(frames: Frames<P>, of: impl Fn(&P) -> &[u8]) -> Vec<u8> {
        let frames = frames.map(Result::unwrap).step_by(24);
        frames.flat_map(|frame| of(&frame.image).to_vec()).collect()
    }
    let video = Video::open(&home().join("captures/walk/normal.mp4")).unwrap();
    let whole = Selection::default();
    let half = Selection {
        height: Some(video.height / 2),
        ..whole.clone()
    };
    let luma = |selection| bytes(video.luma(selection).unwrap(), |image| image.as_raw());
    let given = [
        luma(&whole),
        luma(&half),
        bytes(video.rgb(&whole).unwrap(), |image| image.as_raw()),
    ];
    let given = given.map(|bytes| sha256_hex(&bytes)[..16].to_owned());
    assert_eq!(given, ["7c25a7851aa5027f", "f0872b8ff85b6784", "c548c6abb23dcac6"]);
}

#[test]
fn colours_are_those_that_were_encoded() {
    // Red, green and blue by BT.709 and by BT.601, with and without a tag: full colours come back within what 8 bits of Y'CbCr hold.
    let folder = tempfile::tempdir().unwrap();
    for (size, matrix, tag) in [
        ("1280x720", "bt709", "bt709"),
        ("1280x720", "bt709", ""),
        ("640x360", "bt601", "smpte170m"),
        ("640x360", "bt601", ""),
    ] {
        let path = folder.path().join("colours.mp4");
        let source = format!(
            "color=c=0xc82828:s={size}:r=25:d=0.2,format=rgb24,scale=out_color_matrix={matrix}:out_range=tv,format=yuv420p"
        );
        let tagged: &[&str] = if tag.is_empty() {
            &["-bsf:v", "h264_metadata=matrix_coefficients=2"]
        } else {
            &["-colorspace", tag]
        };
        ffmpeg(
            &[&["-f", "lavfi", "-i", &source, "-c:v", "libx264", "-crf", "1"], tagged].concat(),
            &path,
        );
        let frame = Video::open(&path)
            .unwrap()
            .rgb(&Selection::default())
            .unwrap()
            .next()
            .unwrap()
            .unwrap();
        let [r, g, b] = frame.image.get_pixel(100, 100).0;
        assert!(
            r.abs_diff(200) < 4 && g.abs_diff(40) < 4 && b.abs_diff(40) < 4,
            "{size} {tag}: {r} {g} {b}"
        );
    }
}

#[test]
fn frames_are_upright_however_the_phone_was_held() {
    let folder = tempfile::tempdir().unwrap();
    let path = made(&folder, "across.mp4", &["-c:v", "libx264", "-preset", "ultrafast"]);
    // A player turns clockwise by so much; the lighter half was left.
    for (turned_deg, size, light) in [
        (90, [180, 320], [90, 80]),
        (180, [320, 180], [240, 90]),
        (270, [180, 320], [90, 240]),
    ] {
        let turned = folder.path().join("turned.mp4");
        turn(&path, turned_deg, &turned);
        let video = Video::open(&turned).unwrap();
        assert_eq!((video.turned_deg, [video.width, video.height]), (turned_deg, size));
        let frame = video.luma(&Selection::default()).unwrap().nth(10).unwrap().unwrap();
        assert_eq!(frame.image.dimensions(), size.into());
        let dark = [size[0] - 1 - light[0], size[1] - 1 - light[1]];
        let [light, dark] = [light, dark].map(|[x, y]| frame.image.get_pixel(x, y).0[0]);
        assert!(light > dark + 30, "turned by {turned_deg}°: {light} and {dark}");
    }
}

#[test]
fn times_of_a_variable_frame_rate_are_true_and_selections_go_by_them() {
    let folder = tempfile::tempdir().unwrap();
    // The n-th frame is shown at n²/1000 s.
    let path = made(
        &folder,
        "vfr.mp4",
        &[
            "-vf",
            "settb=1/1000,setpts=N*N",
            "-fps_mode",
            "vfr",
            "-enc_time_base",
            "1/1000",
            // ffmpeg 7 gives the last frame none, and does not show it then.
            "-bsf:v",
            "setts=duration=40",
            "-c:v",
            "libx264",
            "-preset",
            "ultrafast",
            "-video_track_timescale",
            "1000",
        ],
    );
    let video = Video::open(&path).unwrap();
    let seen = |selection: &Selection| -> Vec<(u64, u64)> {
        let frames = video.luma(selection).unwrap().map(Result::unwrap);
        frames
            .map(|frame| (frame.number, (frame.time_s * 1000.0).round() as u64))
            .collect()
    };
    let all: Vec<(u64, u64)> = seen(&Selection::default());
    let expected: Vec<(u64, u64)> = (0..50).map(|n| (n, n * n)).collect();
    assert_eq!(all, expected);
    let some = Selection {
        from_s: 0.1,
        to_s: Some(0.9),
        every: 3,
        ..Selection::default()
    };
    assert_eq!(
        seen(&some),
        [
            (12, 144),
            (15, 225),
            (18, 324),
            (21, 441),
            (24, 576),
            (27, 729),
            (30, 900)
        ]
    );
    let in_a_row = Selection {
        from_s: 0.1,
        to_s: Some(0.5),
        every: 6,
        in_a_row: 2,
        ..Selection::default()
    };
    assert_eq!(seen(&in_a_row), [(12, 144), (13, 169), (18, 324), (19, 361)]);
    let named = Selection {
        numbers: Some(vec![49, 7]),
        ..Selection::default()
    };
    assert_eq!(seen(&named), [(7, 49), (49, 2401)]);
}

#[test]
fn a_clock_that_does_not_begin_at_0_makes_no_film_longer() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        "-c:v",
        "libx264",
        "-crf",
        "1",
        "-g",
        "10",
        "-output_ts_offset",
        "100000",
    ];
    let path = made(&folder, "late.mkv", &options);
    let video = Video::open(&path).unwrap();
    assert_eq!(video.duration_s, Some(2.0));
    let frames = video.luma(&Selection::default()).unwrap();
    assert_eq!(frames.map(Result::unwrap).count(), 50);
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    assert!(refusal(&path).contains("damaged or cut after"));
}

/// A moving picture, with references over frames not shown yet, key frames that those before lean on, and containers that know times to a millisecond or not by an index.
#[test]
fn frames_decoded_from_a_later_beginning_are_the_same_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let videos: [(&str, &[&str]); 6] = [
        ("a.mp4", &["-c:v", "libx264", "-bf", "3", "-g", "10"]),
        ("b.mkv", &["-c:v", "libx264", "-bf", "3", "-g", "250"]),
        (
            "c.mp4",
            &["-c:v", "libx264", "-bf", "3", "-g", "10", "-x264-params", "open-gop=1"],
        ),
        (
            "d.mp4",
            &["-c:v", "libx265", "-x265-params", "log-level=none:keyint=10"],
        ),
        ("e.webm", &["-c:v", "libvpx-vp9", "-g", "10", "-deadline", "realtime"]),
        ("f.ts", &["-c:v", "libx264", "-bf", "3", "-g", "10"]),
    ];
    for (name, options) in videos {
        let path = folder.path().join(name);
        let source = [
            "-f",
            "lavfi",
            "-i",
            "testsrc2=s=320x180:r=30:d=2",
            "-pix_fmt",
            "yuv420p",
        ];
        ffmpeg(&[&source, options].concat(), &path);
        let video = Video::open(&path).unwrap();
        let all: Vec<_> = video.rgb(&Selection::default()).unwrap().map(Result::unwrap).collect();
        assert_eq!(all.len(), 60, "{name}");
        for begin in [0, 19, 33] {
            let numbers = vec![begin as u64, begin as u64 + 1];
            let later = Selection {
                begin: Some((begin as u64, all[begin].time_s)),
                numbers: Some(numbers.clone()),
                is_whole: false,
                ..Selection::default()
            };
            let seen: Vec<_> = video.rgb(&later).unwrap().map(Result::unwrap).collect();
            assert_eq!(
                seen.iter().map(|frame| frame.number).collect::<Vec<_>>(),
                numbers,
                "{name}"
            );
            for (one, same) in seen.iter().zip(&all[begin..]) {
                assert!(
                    (one.time_s - same.time_s).abs() < 1e-5,
                    "{name}: {} {}",
                    one.time_s,
                    same.time_s
                );
                assert!(one.image == same.image, "{name}: frame {}", one.number);
            }
        }
    }
}

/// Also of turned ones, and of an odd width and height.
#[test]
fn colours_of_pictures_that_were_kept_are_those_of_decoding_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, turned] = ["plain.mp4", "turned.mp4"].map(|name| folder.path().join(name));
    let sources: [(&str, &str, &[&str]); 2] = [
        ("testsrc2=s=318x180:r=30:d=1", "bt709", &["-c:v", "libx264", "-bf", "3"]),
        (
            "testsrc=s=321x179:r=30:d=1",
            "smpte170m",
            &["-c:v", "libvpx-vp9", "-deadline", "realtime"],
        ),
    ];
    for (source, matrix, options) in sources {
        let encoded = [
            "-f",
            "lavfi",
            "-i",
            source,
            "-pix_fmt",
            "yuv420p",
            "-colorspace",
            matrix,
        ];
        ffmpeg(&[&encoded[..], options].concat(), &plain);
        turn(&plain, 270, &turned);
        for path in [&plain, &turned] {
            let video = Video::open(path).unwrap();
            let pictures: Vec<_> = video
                .pictures(&Selection::default())
                .unwrap()
                .map(Result::unwrap)
                .collect();
            let luma = video.luma(&Selection::default()).unwrap().map(Result::unwrap);
            let pairs = pictures.iter().zip(luma);
            assert_eq!(
                pairs
                    .filter(|(one, other)| *one.image.whole() == other.image && one.time_s == other.time_s)
                    .count(),
                30
            );
            let kept: Vec<_> = pictures
                .iter()
                .step_by(7)
                .filter_map(|one| one.image.planes().cloned())
                .collect();
            let colours: Vec<_> = video.colours(kept).unwrap().map(Result::unwrap).collect();
            let decoded: Vec<_> = video
                .rgb(&Selection::default())
                .unwrap()
                .map(|frame| frame.unwrap().image)
                .collect();
            assert_eq!(colours.len(), 5);
            assert!(
                colours.iter().eq(decoded.iter().step_by(7)),
                "{source}, {}",
                path.display()
            );
        }
    }
    let ten_bits = made(
        &folder,
        "ten.mp4",
        &[
            "-c:v",
            "libx265",
            "-x265-params",
            "log-level=none",
            "-pix_fmt",
            "yuv420p10le",
        ],
    );
    let mut pictures = Video::open(&ten_bits).unwrap().pictures(&Selection::default()).unwrap();
    assert!(pictures.next().unwrap().unwrap().image.planes().is_none());
}

#[test]
fn what_is_seen_of_a_picture_is_what_the_whole_has_there() {
    let folder = tempfile::tempdir().unwrap();
    for (name, pixels) in [("eight.mp4", "yuv420p"), ("ten.mp4", "yuv420p10le")] {
        let path = folder.path().join(name);
        let source = ["-f", "lavfi", "-i", "testsrc2=s=318x180:r=30:d=0.2", "-pix_fmt", pixels];
        ffmpeg(&[&source[..], &["-c:v", "libx264"]].concat(), &path);
        let video = Video::open(&path).unwrap();
        let pictures = video.pictures(&Selection::default()).unwrap();
        let pictures: Vec<Picture> = pictures.map(|frame| frame.unwrap().image).collect();
        let (one, other) = (&pictures[0], &pictures[5]);
        assert_eq!(one.size(), [318, 180]);
        let difference = one.difference(other).unwrap();
        let parts = [([0, 0], [1, 1]), ([17, 3], [40, 60]), ([300, 170], [18, 10])];
        let seen = parts.map(|(start, size)| one.part(start, size));
        let reduced = one.reduced(2).into_owned();
        for ((start, size), seen) in parts.into_iter().zip(seen) {
            assert_eq!(seen, one.whole().part(start, size), "{name}");
        }
        let of_whole = one.whole().reduced(2).into_owned();
        // Both are rounded, at steps of 1 and of 255/219.
        let levels_off = reduced.iter().zip(of_whole.iter()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(levels_off.unwrap() <= 2, "{name}");
        let rows = |picture: &Picture| -> Vec<u8> {
            picture
                .whole()
                .chunks_exact(318)
                .step_by(4)
                .flatten()
                .copied()
                .collect()
        };
        let off = rows(one)
            .into_iter()
            .zip(rows(other))
            .map(|(a, b)| f64::from(a.abs_diff(b)));
        let expected = off.sum::<f64>() / rows(one).len() as f64;
        assert!(
            (difference - expected).abs() < 0.5 && expected > 2.0,
            "{name}: {difference}, not {expected}"
        );
    }
}

#[test]
fn hdr_is_named_and_its_white_paper_is_white() {
    let folder = tempfile::tempdir().unwrap();
    // White paper of 203 cd/m² has 58 % of PQ's signal and 75 % of HLG's (ITU-R BT.2408, table 1).
    for (transfer, range, signal) in [("smpte2084", Range::Pq, 0.58), ("arib-std-b67", Range::Hlg, 0.75)] {
        let path = folder.path().join("hdr.mp4");
        for (share, [least, most]) in [(1.0, [250, 255]), (0.5, [20, 190])] {
            let luma = (64.0 + 876.0 * signal * share) as u32;
            let source = format!("color=c=black:s=320x180:r=25:d=0.2,format=yuv420p10le,geq=lum={luma}:cb=512:cr=512");
            let tags = format!("log-level=none:colorprim=bt2020:transfer={transfer}:colormatrix=bt2020nc");
            ffmpeg(
                &[
                    "-f",
                    "lavfi",
                    "-i",
                    &source,
                    "-c:v",
                    "libx265",
                    "-preset",
                    "ultrafast",
                    "-crf",
                    "5",
                    "-x265-params",
                    &tags,
                ],
                &path,
            );
            let video = Video::open(&path).unwrap();
            assert_eq!((video.range, video.bits), (range, 10));
            assert!(video.colour_note().unwrap().contains(range.name()));
            let frame = video.rgb(&Selection::default()).unwrap().next().unwrap().unwrap();
            let [r, g, b] = frame.image.get_pixel(100, 100).0;
            assert!(r.abs_diff(g) < 3 && g.abs_diff(b) < 3, "{transfer}: {r} {g} {b}");
            assert!((least..=most).contains(&g), "{transfer}, {share} of white: {g}");
        }
        // What is wrong is the film, not what ffmpeg is told.
        let mut bytes = std::fs::read(&path).unwrap();
        let start = bytes.windows(4).position(|name| name == b"mdat").unwrap();
        let length = u32::from_be_bytes(bytes[start - 4..start].try_into().unwrap()) as usize - 8;
        bytes[start + 4..][length / 2..length].fill(0x55);
        std::fs::write(&path, bytes).unwrap();
        let video = Video::open(&path).unwrap();
        let fault = video.rgb(&Selection::default()).unwrap().find_map(Result::err).unwrap();
        assert!(matches!(fault, VideoError::Damaged { .. }), "{fault}");
    }
}

#[test]
fn what_is_no_whole_video_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let written = |name: &str, bytes: &[u8]| {
        std::fs::write(place(name), bytes).unwrap();
        place(name)
    };
    let h264 = ["-c:v", "libx264", "-preset", "ultrafast", "-crf", "1", "-g", "10"];
    let whole = made(&folder, "whole.mp4", &[&h264[..], &["-movflags", "faststart"]].concat());
    let bytes = std::fs::read(&whole).unwrap();

    assert!(refusal(&written("empty.mp4", b"")).contains("is empty"));
    assert!(refusal(&written("words.mp4", b"These are words.\n")).contains("no video that is read here"));
    assert!(refusal(&place("missing.mp4")).contains("no such file"));
    assert!(refusal(folder.path()).contains("it is not a file"));
    // Index in front, and half of the frames.
    let cut = refusal(&written("cut.mp4", &bytes[..bytes.len() / 2]));
    assert!(cut.contains("damaged or cut after"), "{cut}");
    // Bytes changed in the middle: ffmpeg would make up what is missing.
    let mut hurt = bytes.clone();
    let middle = bytes.len() / 2;
    hurt[middle..middle + 3000].fill(0x55);
    let hurt = refusal(&written("hurt.mp4", &hurt));
    assert!(hurt.contains("damaged or cut after"), "{hurt}");
    // Index at the end, which is cut away.
    let end = std::fs::read(made(&folder, "end.mp4", &h264)).unwrap();
    let cut = refusal(&written("no_index.mp4", &end[..end.len() / 2]));
    assert!(cut.contains("no video that is read here"), "{cut}");
    let mkv = std::fs::read(made(&folder, "a.mkv", &h264)).unwrap();
    let cut = refusal(&written("cut.mkv", &mkv[..mkv.len() / 2]));
    assert!(cut.contains("damaged or cut after"), "{cut}");

    ffmpeg(&["-f", "lavfi", "-i", "sine=d=1"], &place("sound.m4a"));
    assert!(refusal(&place("sound.m4a")).contains("sound and no picture"));
    ffmpeg(
        &["-f", "lavfi", "-i", GREYS, "-t", "0", "-c:v", "libx264"],
        &place("none.mp4"),
    );
    let none = refusal(&place("none.mp4"));
    assert!(
        none.contains("no frame") || none.contains("no video that is read"),
        "{none}"
    );
    let key = "00112233445566778899aabbccddeeff";
    ffmpeg(
        &[
            "-i",
            whole.to_str().unwrap(),
            "-c",
            "copy",
            "-encryption_scheme",
            "cenc-aes-ctr",
            "-encryption_key",
            key,
            "-encryption_kid",
            key,
        ],
        &place("secret.mp4"),
    );
    let secret = refusal(&place("secret.mp4"));
    assert!(secret.contains("is encrypted"), "{secret}");

    // 10 hours by its header: Matroska's element Duration (0x4489, eight bytes), ms.
    let mut long = mkv.clone();
    let at = mkv.windows(3).position(|bytes| bytes == [0x44, 0x89, 0x88]).unwrap() + 3;
    long[at..at + 8].copy_from_slice(&36e6_f64.to_be_bytes());
    let long = written("long.mkv", &long);
    assert_eq!(Video::open(&long).unwrap().duration_s, Some(36_000.0));
    let cut = refusal(&long);
    assert!(cut.contains("its header says that more follows"), "{cut}");
    // One black frame of 38 megapixels.
    ffmpeg(
        &[
            "-f",
            "lavfi",
            "-i",
            "color=s=8320x4608:d=0.04",
            "-c:v",
            "libx264",
            "-preset",
            "ultrafast",
        ],
        &place("huge.mp4"),
    );
    assert!(refusal(&place("huge.mp4")).contains("8320 × 4608 px"));
    ffmpeg(
        &[
            "-f",
            "lavfi",
            "-i",
            "color=s=320x180:d=0.2,setsar=4/3",
            "-c:v",
            "libx264",
        ],
        &place("wide.mp4"),
    );
    assert!(refusal(&place("wide.mp4")).contains("not square (4:3)"));
}

#[test]
fn a_file_cannot_make_ffmpeg_read_another() {
    let folder = tempfile::tempdir().unwrap();
    let video = made(&folder, "secret.mp4", &["-c:v", "libx264", "-preset", "ultrafast"]);
    let scripts = [
        ("list.mp4", format!("ffconcat version 1.0\nfile {}\n", video.display())),
        (
            "playlist.mp4",
            format!(
                "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\n{}\n#EXT-X-ENDLIST\n",
                video.display()
            ),
        ),
    ];
    for (name, script) in scripts {
        let path = folder.path().join(name);
        std::fs::write(&path, script).unwrap();
        let sentence = refusal(&path);
        assert!(sentence.contains("no video that is read here"), "{sentence}");
    }
}

#[test]
fn ffmpeg_ends_when_its_frames_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let path = made(&folder, "dropped.mp4", &["-c:v", "libx264", "-preset", "ultrafast"]);
    let whole = path.canonicalize().unwrap();
    // The film is its standard input.
    let runs = || {
        let inputs = std::fs::read_dir("/proc")
            .unwrap()
            .flatten()
            .filter_map(|process| std::fs::read_link(process.path().join("fd/0")).ok());
        inputs.filter(|input| *input == whole).count()
    };
    let mut frames = Video::open(&path).unwrap().rgb(&Selection::default()).unwrap();
    assert!(matches!(frames.next(), Some(Ok(_))));
    assert_eq!(runs(), 1);
    drop(frames);
    assert_eq!(runs(), 0);
}

#[test]
fn a_video_that_is_only_named_is_no_error_of_ours() {
    let missing = Video::open(Path::new("/nowhere/walk.mp4")).unwrap_err();
    assert!(matches!(missing, VideoError::File(_)), "{missing}");
}
