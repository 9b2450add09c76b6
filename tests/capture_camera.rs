//! A running camera without one: known images in every pixel format, a slow reader, and a cable that is pulled.

use crate::capture::live;
use crate::common;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use common::{HANG, assert_refused, program, read_json, skyline, stdout};
use image::{Rgb, RgbImage};
use live::live_capture;
use scaleproof_capture::live::{Device, LiveCameraError, PixelFormat, RawImage, Setting};
use scaleproof_capture::{CameraSettings, Capture, FrameSource, LiveCamera, Original};
use scaleproof_core::message::Hint;
use scaleproof_photo::{Budget, Photo};
use scaleproof_pose::scene::Scene;

/// A camera that answers at all opens within this time.
const LIMIT: Duration = HANG;

/// Patches of 8 × 8 px of many colours.
fn known() -> RgbImage {
    RgbImage::from_fn(96, 64, |x, y| {
        let (i, j) = ((x / 8) as u8, (y / 8) as u8);
        Rgb([20 + 18 * i, 240 - 25 * j, 30 + 8 * i + 10 * j])
    })
}

/// ITU-R BT.601: E'Y = 0.299 R + 0.587 G + 0.114 B; Y = 16 + 219 E'Y, Cb = 128 + 224 (B − E'Y) / 1.772, Cr = 128 + 224 (R − E'Y) / 1.402.
fn ycbcr(rgb: &Rgb<u8>) -> [u8; 3] {
    let [r, g, b] = rgb.0.map(|v| f64::from(v) / 255.0);
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    [
        16.0 + 219.0 * luma,
        128.0 + 224.0 * (b - luma) / 1.772,
        128.0 + 224.0 * (r - luma) / 1.402,
    ]
    .map(|v| v.round() as u8)
}

/// The bytes of an image as a camera packs them, by the definition of each format.
fn packed(picture: &RgbImage, format: PixelFormat) -> Vec<u8> {
    let (width, height) = picture.dimensions();
    let at = |x: u32, y: u32| ycbcr(picture.get_pixel(x, y));
    match format {
        PixelFormat::Rgb => picture.as_raw().clone(),
        PixelFormat::Bgr => picture.pixels().flat_map(|p| [p[2], p[1], p[0]]).collect(),
        PixelFormat::Grey => picture.pixels().map(|p| p[1]).collect(),
        PixelFormat::Yuyv => {
            let pair = |y: u32, x: u32| {
                let ([y1, u, v], [y2, ..]) = (at(x, y), at(x + 1, y));
                [y1, u, y2, v]
            };
            (0..height)
                .flat_map(|y| (0..width).step_by(2).flat_map(move |x| pair(y, x)))
                .collect()
        }
        PixelFormat::Nv12 => {
            let luma = (0..height).flat_map(|y| (0..width).map(move |x| at(x, y)[0]));
            let rows = (0..height).step_by(2);
            let chroma = rows.flat_map(|y| (0..width).step_by(2).flat_map(move |x| [at(x, y)[1], at(x, y)[2]]));
            luma.chain(chroma).collect()
        }
        PixelFormat::Mjpeg => jpeg(picture),
    }
}

fn jpeg(picture: &RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 97);
    encoder.encode_image(picture).unwrap();
    bytes
}

/// Without its Huffman tables, as motion JPEG is often sent.
fn without_tables(jpeg: &[u8]) -> Vec<u8> {
    let (mut at, mut left) = (2, jpeg[..2].to_vec());
    loop {
        let length = 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
        match jpeg[at + 1] {
            0xDA => break,
            0xC4 => {}
            _ => left.extend_from_slice(&jpeg[at..at + length]),
        }
        at += length;
    }
    left.extend_from_slice(&jpeg[at..]);
    left
}

fn raw(picture: &RgbImage, format: PixelFormat, bytes: Vec<u8>) -> RawImage {
    RawImage {
        format,
        width: picture.width(),
        height: picture.height(),
        bytes,
    }
}

fn decoded(original: Original) -> RgbImage {
    match original {
        Original::Pixels(rgb) => rgb,
        Original::Encoded(bytes) => Photo::from_bytes(Path::new("frame"), bytes, Budget::FILE)
            .unwrap()
            .rgb(1)
            .unwrap(),
        Original::Unreadable(sentence) => panic!("{sentence}"),
    }
}

fn worst(a: &RgbImage, b: &RgbImage) -> u8 {
    a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn known_frames_of_every_format_are_decoded() {
    let picture = known();
    let grey = RgbImage::from_fn(96, 64, |x, y| Rgb([picture.get_pixel(x, y)[1]; 3]));
    let formats = [
        (PixelFormat::Rgb, &picture, 0),
        (PixelFormat::Bgr, &picture, 0),
        (PixelFormat::Grey, &grey, 0),
        (PixelFormat::Yuyv, &picture, 3), // rounding of Y', Cb and Cr
        (PixelFormat::Nv12, &picture, 3),
        (PixelFormat::Mjpeg, &picture, 12),
    ];
    for (format, truth, limit) in formats {
        let bytes = packed(&picture, format);
        let whole = decoded(raw(&picture, format, bytes.clone()).original().unwrap());
        let off = worst(&whole, truth);
        println!("{format:?}: worst {off} of 255");
        assert_eq!(whole.dimensions(), truth.dimensions());
        assert!(off <= limit, "{format:?}: {off}");
        // Drivers hand out whole buffers: what an earlier image left behind this one is not part of it.
        let longer = [bytes.clone(), bytes[bytes.len() / 3..].to_vec()].concat();
        assert_eq!(
            decoded(raw(&picture, format, longer).original().unwrap()),
            whole,
            "{format:?}"
        );
        let half = bytes[..bytes.len() / 2].to_vec();
        let sentence = raw(&picture, format, half).original().unwrap_err();
        assert!(sentence.contains("half an image"), "{format:?}: {sentence}");
        assert!(raw(&picture, format, Vec::new()).original().is_err());
    }
    let odd = RawImage {
        width: 95,
        ..raw(&picture, PixelFormat::Yuyv, packed(&picture, PixelFormat::Yuyv))
    };
    assert!(odd.original().is_err());
}

/// What is kept of a motion JPEG is a JPEG that any program opens: that of libjpeg, whose tables were taken out, byte for byte again.
#[test]
fn motion_jpegs_become_whole_files() {
    let stored = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    let kept = |sent: &[u8]| match raw(&known(), PixelFormat::Mjpeg, sent.to_vec()).original().unwrap() {
        Original::Encoded(bytes) => bytes,
        other => panic!("{other:?}"),
    };
    assert!(kept(&stored) == stored);
    let bare = without_tables(&stored);
    assert!(bare.len() + 400 < stored.len(), "the tables have 420 bytes");
    let rgb = |bytes: Vec<u8>| {
        Photo::from_bytes(Path::new("frame"), bytes, Budget::FILE)
            .unwrap()
            .rgb(1)
            .unwrap()
    };
    assert!(rgb(kept(&bare)) == rgb(stored));
}

/// What a fake camera does: an image every `every`, and after `last` of them only failures.
struct Fake {
    pictures: Vec<RawImage>,
    every: Duration,
    sent: Arc<AtomicU32>,
    last: u32,
}

impl Device for Fake {
    fn image(&mut self) -> Result<RawImage, LiveCameraError> {
        std::thread::sleep(self.every);
        let count = self.sent.load(Ordering::SeqCst);
        if count == self.last {
            return Err(LiveCameraError::Failed("no such device".into()));
        }
        self.sent.store(count + 1, Ordering::SeqCst);
        Ok(self.pictures[count as usize % self.pictures.len()].clone())
    }

    fn lock(&mut self) -> CameraSettings {
        CameraSettings {
            device: "Fake".into(),
            format: "GRAY 96 × 64, 100 frames a second".into(),
            exposure: Setting {
                is_locked: true,
                value: Some(157),
            },
            focus: Setting::default(),
            white_balance: Setting {
                is_locked: true,
                value: Some(4600),
            },
        }
    }
}

fn fake(pictures: Vec<RawImage>, every_ms: u64, last: u32) -> (LiveCamera, Arc<AtomicU32>) {
    let sent = Arc::new(AtomicU32::new(0));
    let device = Fake {
        pictures,
        every: Duration::from_millis(every_ms),
        sent: Arc::clone(&sent),
        last,
    };
    (
        LiveCamera::from_device(3, LIMIT, move || Ok(Box::new(device))).unwrap(),
        sent,
    )
}

fn number(name: &str) -> u32 {
    name.rsplit_once(' ').unwrap().1.parse().unwrap()
}

/// Who judges an image for 300 ms is given the newest one then, not the thirty that came meanwhile.
#[test]
fn a_stale_picture_is_never_queued() {
    let grey = raw(&known(), PixelFormat::Grey, packed(&known(), PixelFormat::Grey));
    let (mut camera, sent) = fake(vec![grey], 10, u32::MAX);
    assert!(camera.is_stream() && camera.settings().is_none());
    for _ in 0..4 {
        let before = sent.load(Ordering::SeqCst);
        let frame = camera.next().unwrap().unwrap();
        // One that was sent may not have arrived.
        assert!(
            number(&frame.name) + 2 >= before,
            "{} when {before} had come",
            frame.name
        );
        std::thread::sleep(Duration::from_millis(300));
    }
    let settings = camera.settings().unwrap();
    assert_eq!(
        settings.to_string(),
        "Fake, GRAY 96 × 64, 100 frames a second: focus cannot be held by this program and may change from photo to photo"
    );
    // Nobody listens any more: the thread lets the camera go.
    drop(camera);
    let start = Instant::now();
    while Arc::strong_count(&sent) > 1 {
        assert!(start.elapsed() < HANG, "the camera is still held");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_camera_that_cannot_be_used_is_one_sentence() {
    let refused = LiveCamera::from_device(3, LIMIT, || Err(LiveCameraError::Failed("it is busy".into())))
        .err()
        .unwrap();
    assert_eq!(refused.to_string(), "the camera 3 cannot be used (it is busy)");
    let hint = Hint::of(&refused).unwrap().to_string();
    assert_eq!(hint, "see `scaleproof capture list-cameras`");
    // A driver that panics, and one that says nothing.
    let broken = LiveCamera::from_device(3, LIMIT, || panic!("driver")).err().unwrap();
    assert!(broken.to_string().contains("its driver failed"), "{broken}");
    let hanging = LiveCamera::from_device(3, Duration::from_secs(2), || {
        std::thread::sleep(Duration::from_secs(60));
        Err(LiveCameraError::Failed("nobody waits for this".into()))
    });
    let hanging = hanging.err().unwrap().to_string();
    assert!(hanging.contains("did not open within 2 s"), "{hanging}");
    let (mut silent, _) = fake(Vec::new(), 60_000, u32::MAX);
    let gone = silent.next().unwrap_err().to_string();
    assert!(gone.contains("none came for 5 s"), "{gone}");
    // The program: a camera that is not there, and the list of those that are.
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let mut command = program();
    command.args([
        "capture",
        "--source",
        "camera:97",
        "--variant",
        "normal",
        "--place",
        "yard",
    ]);
    command.arg("--scene").arg(skyline().join("scene.toml"));
    command
        .arg("--camera")
        .arg(skyline().join("camera.yaml"))
        .arg("-o")
        .arg(&session);
    assert_refused(
        &command.output().unwrap(),
        &["camera 97", "hint: see `scaleproof capture list-cameras`"],
    );
    assert!(!session.exists());
    let listed = program().args(["capture", "list-cameras", "--json"]).output().unwrap();
    let told: serde_json::Value = serde_json::from_slice(&listed.stdout).unwrap();
    assert!(told["cameras"].is_array(), "{told}");
    let listed = program().args(["capture", "list-cameras"]).output().unwrap();
    assert!(listed.status.success());
    assert!(
        stdout(&listed)
            .lines()
            .all(|line| line.starts_with("camera:") || line.starts_with("no camera"))
    );
}

/// The whole way: a running camera that shows two views, each held still; pulled out, and plugged in again.
#[test]
fn a_camera_fills_the_session_and_goes_on_after_it_was_unplugged() {
    let out = tempfile::tempdir().unwrap();
    let session = out.path().join("session");
    let view = |i: u32| {
        let sent = std::fs::read(skyline().join(format!("normal_{i:03}.jpg"))).unwrap();
        RawImage {
            format: PixelFormat::Mjpeg,
            width: 1280,
            height: 960,
            bytes: without_tables(&sent),
        }
    };
    let filled = |views: Vec<RawImage>, last: u32| {
        let (mut camera, _) = fake(views, 50, last);
        let mut capture = capture(&session);
        loop {
            let frame = match camera.next() {
                Ok(frame) => frame.unwrap(),
                Err(gone) => {
                    return (
                        capture
                            .guidance()
                            .targets()
                            .iter()
                            .filter(|t| t.photo.is_some())
                            .count(),
                        gone.to_string(),
                    );
                }
            };
            capture.set_camera_settings(camera.settings());
            capture.see(&frame).unwrap();
        }
    };
    // Some 1.5 s pass before the camera has settled.
    let (count, sentence) = filled(vec![view(0)], 120);
    assert_eq!(count, 1);
    assert_eq!(
        sentence,
        "the camera 3 gives no more images (no such device): plug it in again and run this again; what was accepted is kept"
    );
    let (count, _) = filled(vec![view(2)], 120);
    assert_eq!(count, 2, "the first view is kept");
    let sidecar = read_json(&session.join("normal_001.capture.json"));
    assert_eq!(
        sidecar["camera"]["exposure"],
        serde_json::json!({"is_locked": true, "value": 157})
    );
    assert_eq!(sidecar["camera"]["focus"]["is_locked"], false);
    assert!(sidecar["gates"]["moved_px"].as_f64().is_some());
    assert!(sidecar.get("is_by_hand").is_none());
    Photo::open(&session.join("normal_001.jpg")).unwrap();
}

fn capture(session: &Path) -> Capture {
    let scene = Scene::open(&skyline().join("scene.toml")).unwrap();
    live_capture(session, &scene, scene.bins.usual_view().1)
}
