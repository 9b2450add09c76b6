//! Images that are tiny, huge, cut, or cost more than they seem, given to every command that reads one.

use std::io::Cursor;
use std::path::Path;
use std::time::Instant;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ExtendedColorType, GrayImage, ImageEncoder, ImageFormat, Luma, RgbImage};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use scaleproof_photo::Photo;
use scaleproof_pose::scene::TagFamily;
use scaleproof_pose::tags::TagDetectorChoice;

use crate::common::{self, home, program, skyline, stderr};
use crate::hostile::bounded;

/// A name, its bytes, and words of the sentence about it; no words where an image may be accepted or refused.
type Case = (&'static str, Vec<u8>, &'static [&'static str]);

fn cases() -> Vec<Case> {
    let whole = std::fs::read(skyline().join("normal_000.jpg")).unwrap();
    vec![
        ("1x1.png", png(&flat(1, 1)), &[]),
        ("4x2.png", png(&flat(4, 2)), &[]),
        ("3x4.jpg", jpeg(&flat(3, 4)), &[]),
        ("1x5000.png", png(&flat(1, 5000)), &[]),
        ("15x15.jpg", jpeg(&flat(15, 15)), &[]),
        ("long.png", png(&flat(65_535, 64)), &[]),
        ("high.png", png(&flat(40, 40_000)), &[]),
        ("empty.jpg", Vec::new(), &["not a JPEG or PNG"]),
        ("text.png", b"this is a shopping list".to_vec(), &["not a JPEG or PNG"]),
        ("cut.jpg", whole[..whole.len() / 2].to_vec(), &["ends in the middle"]),
        (
            "terapixels.png",
            claiming(&png(&flat(1, 1)), [1_000_000; 2]),
            &["megapixels"],
        ),
        (
            "scans.jpg",
            jpeg_of_scans(1600, 1200, Scans::Refining, 2000),
            &["2001 scans", "save it again"],
        ),
        (
            "sequential.jpg",
            jpeg_of_scans(1600, 1200, Scans::Sequential, 20),
            &["21 scans"],
        ),
        ("profile.png", with_profile(&png(&flat(64, 64))), &[]),
        (
            "many_scans.jpg",
            jpeg_of_scans(16_000, 12_000, Scans::Refining, 20),
            &["21 scans"],
        ),
        ("deep.png", deep(15_000, 12_000), &["MB to decode"]),
    ]
}

/// Every command that reads an image of a user's; `PICTURE` stands for it, `OUT` for a folder. `score` and `capture` follow below.
const COMMANDS: [&str; 10] = [
    "locate PICTURE --scene SCENE --camera CAMERA",
    "calibrate --board BOARD PICTURE -o OUT/camera.yaml",
    "calibrate --board CHESSBOARD PICTURE -o OUT/camera.yaml",
    "colour read PICTURE -o OUT/printer.toml",
    "camera guess PICTURE -o OUT/camera.yaml",
    "survey PICTURE --camera CAMERA --scene SCENE --fixed mat -o OUT/scene.toml",
    "pattern check PICTURE",
    "pattern import PICTURE -o OUT/pattern.png",
    "print template --texture PICTURE --tile-mm 60 --size-mm 100x100 -o OUT/template.pdf",
    "print patch --scene SCENE --patch PICTURE --panel left --at-mm 0,50 --size-mm 60x40 -o OUT/patch.pdf",
];

#[test]
fn every_command_survives_every_picture() {
    for (name, bytes, words) in cases() {
        let folder = tempfile::tempdir().unwrap();
        let pictures = folder.path().join("pictures");
        std::fs::create_dir(&pictures).unwrap();
        std::fs::write(pictures.join(name), &bytes).unwrap();
        for (number, command) in COMMANDS.into_iter().enumerate() {
            let out = folder.path().join(number.to_string());
            std::fs::create_dir(&out).unwrap();
            let filled = |argument: &str| match argument {
                "PICTURE" => pictures.join(name).display().to_string(),
                "SCENE" => skyline().join("scene.toml").display().to_string(),
                "CAMERA" => skyline().join("camera.yaml").display().to_string(),
                "CHESSBOARD" => home()
                    .join("calibration/chessboard_10x7_20mm.toml")
                    .display()
                    .to_string(),
                "BOARD" => home().join("calibration/charuco_9x7_22mm.toml").display().to_string(),
                other => other.replace("OUT", &out.display().to_string()),
            };
            let ended = bounded::run(program().args(command.split_whitespace().map(filled)));
            let said = stderr(&ended.output) + &String::from_utf8_lossy(&ended.output.stdout);
            let most = if name == "profile.png" { 250 << 20 } else { 1 << 30 };
            assert!(ended.memory < most, "{command} {name}: {} MB", ended.memory >> 20);
            let code = ended.output.status.code();
            assert!(matches!(code, Some(0 | 2)), "{command} {name}: {code:?} {said}");
            // Commands that take PNG patterns say in their own words what is no pattern.
            if !words.is_empty() && !command.starts_with(['p']) {
                assert_eq!(code, Some(2), "{command} {name}: {said}");
                words
                    .iter()
                    .for_each(|word| assert!(said.contains(word), "{command} {name}: `{word}` is not in {said}"));
            }
            if code == Some(2) {
                assert_eq!(left_in(&out), Vec::<String>::new(), "{command} {name} leaves files");
            }
        }
    }
}

/// Files in a folder.
fn left_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect()
}

/// A watched folder of all of them, and of a good photo: each is judged, and the good one taken.
#[test]
fn a_capture_sees_a_folder_of_hostile_pictures_through() {
    let folder = tempfile::tempdir().unwrap();
    let (pictures, session) = (folder.path().join("pictures"), folder.path().join("session"));
    std::fs::create_dir(&pictures).unwrap();
    for (name, bytes, _) in cases() {
        std::fs::write(pictures.join(name), bytes).unwrap();
    }
    std::fs::copy(skyline().join("normal_000.jpg"), pictures.join("good.jpg")).unwrap();
    let mut command = program();
    command
        .arg("capture")
        .arg("--source")
        .arg(format!("watch:{}", pictures.display()));
    command.arg("--scene").arg(skyline().join("scene.toml"));
    command.arg("--camera").arg(skyline().join("camera.yaml"));
    command
        .args(["--headless", "--variant", "normal", "--place", "yard", "-o"])
        .arg(&session);
    let ended = bounded::run(&mut command);
    let said = String::from_utf8_lossy(&ended.output.stdout);
    assert_eq!(ended.output.status.code(), Some(2), "{said}");
    for (name, _, words) in cases() {
        let line = said.lines().find(|line| line.starts_with(name));
        let line = line.unwrap_or_else(|| panic!("nothing is said of {name}: {said}"));
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    }
    assert!(session.join("normal_000.jpg").exists(), "{said}");
    assert!(ended.memory < 1 << 30, "{} MB", ended.memory >> 20);
}

/// A session with one such photo: it is scored without it, or with it, and says why.
#[test]
fn score_survives_every_picture_and_refuses_what_locate_refuses() {
    for (name, bytes, words) in cases() {
        let session = crate::common::copy_of_skyline();
        std::fs::write(session.path().join("normal_000.jpg"), bytes).unwrap();
        let out = tempfile::tempdir().unwrap();
        let mut command = program();
        command
            .arg("score")
            .arg(session.path())
            .arg("--recorded")
            .arg("--out")
            .arg(out.path());
        let ended = bounded::run(&mut command);
        let said = stderr(&ended.output);
        assert_eq!(ended.output.status.code(), Some(0), "{name}: {said}");
        let about: Vec<&str> = said.lines().filter(|line| line.contains("normal_000.jpg")).collect();
        let is_told = |line: &str| words.iter().all(|word| line.contains(word));
        assert!(matches!(about[..], [line] if is_told(line)), "{name}: {said}");
    }
}

/// What is within the budgets costs at most what the table in docs/guide/limits.md says: fine texture for the search, zeros for the scans. With
/// `SCALEPROOF_MEGAPIXELS=249` the largest.
#[test]
fn the_worst_pictures_within_the_budget_take_bounded_memory() {
    let megapixels = common::number::<f64>("SCALEPROOF_MEGAPIXELS");
    // Half a minute for the largest JPEGs is too long for every run of the tests.
    let jpeg_px = if megapixels.is_some() {
        (6400, 4800)
    } else {
        (1600, 1200)
    };
    let megapixels = megapixels.unwrap_or(120.0_f64);
    let side = (megapixels * 1e6).sqrt() as u32 / 12 * 12;
    let reduction = (megapixels / 34.0).sqrt().ceil() as u32;
    let folder = tempfile::tempdir().unwrap();
    let camera = folder.path().join("square.yaml");
    let text = std::fs::read_to_string(skyline().join("camera.yaml")).unwrap();
    std::fs::write(&camera, text.replace("image_width: 1280", "image_width: 960")).unwrap();
    for (name, bytes, is_square, word) in [
        ("texture.png", texture(side, 2 * reduction), true, "no tag"),
        (
            "zeros.jpg",
            jpeg_of_scans(jpeg_px.0, jpeg_px.1, Scans::Refining, 63),
            false,
            "no tag",
        ),
        (
            "nothing.jpg",
            jpeg_of_scans(jpeg_px.0, jpeg_px.1, Scans::Empty, 63),
            false,
            "its data ends before the picture does",
        ),
    ] {
        let photo = folder.path().join(name);
        std::fs::write(&photo, &bytes).unwrap();
        let mut command = program();
        command
            .arg("locate")
            .arg(&photo)
            .arg("--scene")
            .arg(skyline().join("scene.toml"));
        command.arg("--camera").arg(if is_square {
            camera.clone()
        } else {
            skyline().join("camera.yaml")
        });
        let begin = Instant::now();
        let ended = bounded::run(&mut command);
        println!(
            "{name}, {} kB: {:?}, {} MB",
            bytes.len() / 1000,
            begin.elapsed(),
            ended.memory / 1_000_000
        );
        let said = stderr(&ended.output);
        assert_eq!(ended.output.status.code(), Some(2), "{said}");
        assert!(said.contains(word), "{said}");
        assert!(ended.memory < 2_000_000_000, "{} MB", ended.memory >> 20);
    }
    // Reduced images for networks, and all three colours at full size.
    for (name, reduction) in [
        ("zeros.jpg", 8),
        ("nothing.jpg", 8),
        ("zeros.jpg", 1),
        ("nothing.jpg", 1),
    ] {
        let file = Photo::open(&folder.path().join(name)).unwrap();
        let begin = Instant::now();
        let read = file.rgb(reduction).map(|picture| picture.dimensions());
        println!("{name} at 1/{reduction}: {:?}, {read:?}", begin.elapsed());
    }
}

/// In this process: what a C library reads beyond its image would end the test.
#[test]
fn every_tag_detector_survives_small_sizes() {
    let mut random = Pcg64::seed_from_u64(13);
    // All of the smallest, and larger ones of every width and height.
    let smallest = (1..=20).flat_map(|w| (1..=20).map(move |h| (w, h)));
    let larger = (21..=64).flat_map(|w| {
        [1, 2, 7, 16, 33, 85 - w]
            .map(|h| (w, h))
            .into_iter()
            .chain([(16, w), (3, w)])
    });
    let sizes: Vec<(u32, u32)> = smallest.chain(larger).collect();
    for choice in TagDetectorChoice::ALL.into_iter().chain(TagDetectorChoice::PEERS) {
        let mut detector = choice.open(&[TagFamily::Tag36h11]).unwrap();
        for &(width, height) in &sizes {
            let mut noise = GrayImage::new(width, height);
            random.fill_bytes(&mut noise);
            detector.find(&noise);
        }
        for (width, height) in [(40_000, 3), (65_535, 64), (64, 33_000)] {
            detector.find(&GrayImage::from_pixel(width, height, Luma([90])));
        }
        detector.find(&GrayImage::new(0, 0));
    }
}

fn flat(width: u32, height: u32) -> RgbImage {
    RgbImage::from_pixel(width, height, image::Rgb([120, 130, 140]))
}

fn png(picture: &RgbImage) -> Vec<u8> {
    encoded(picture, ImageFormat::Png)
}

fn jpeg(picture: &RgbImage) -> Vec<u8> {
    encoded(picture, ImageFormat::Jpeg)
}

fn encoded(picture: &RgbImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::from(picture.clone())
        .write_to(&mut bytes, format)
        .unwrap();
    bytes.into_inner()
}

/// A PNG whose header claims this width and height.
fn claiming(png: &[u8], [width, height]: [u32; 2]) -> Vec<u8> {
    let mut bytes = png.to_vec();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    bytes
}

/// A small file: 16-bit RGBA of one colour.
fn deep(width: u32, height: u32) -> Vec<u8> {
    // Its header is all that is read.
    let mut bytes = Vec::new();
    let one = [0x40; 8];
    PngEncoder::new(&mut bytes)
        .write_image(&one, 1, 1, ExtendedColorType::Rgba16)
        .unwrap();
    claiming(&bytes, [width, height])
}

/// CRC-32 as PNG uses it (RFC 2083, 15), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, b| {
        (0..8).fold(crc ^ u32::from(*b), |c, _| {
            if c & 1 == 1 { c >> 1 ^ 0xEDB8_8320 } else { c >> 1 }
        })
    })
}

/// A PNG that is all edges when it is searched: 64 × 64 squares, dark or light by chance, over and over. The smallest squares cost most, 2 px
/// in the image that is searched.
fn texture(side: u32, square_px: u32) -> Vec<u8> {
    let mut random = Pcg64::seed_from_u64(1);
    let cells: Vec<u64> = (0..64).map(|_| random.next_u64()).collect();
    let row = |y: u32| -> Vec<u8> {
        let cells = cells[(y / square_px % 64) as usize];
        let level = |x: u32| {
            if cells >> (x / square_px % 64) & 1 == 1 {
                20
            } else {
                235
            }
        };
        (0..side).map(level).collect()
    };
    let pixels: Vec<u8> = (0..side).flat_map(row).collect();
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Fast, FilterType::Up)
        .write_image(&pixels, side, side, ExtendedColorType::L8)
        .unwrap();
    bytes
}

/// What a decoder does for each scan after the first.
#[derive(Clone, Copy, PartialEq)]
pub enum Scans {
    /// Refines AC coefficients, all zero: a walk over the image for a dozen bytes each 200,000 blocks.
    Refining,
    /// Has no data for the AC coefficients; many decoders go on with zeros.
    Empty,
    /// All coefficients, in a frame that should have one scan.
    Sequential,
}

/// A grey JPEG (ITU-T T.81) with a first scan and `more`.
pub fn jpeg_of_scans(width: u16, height: u16, scans: Scans, more: usize) -> Vec<u8> {
    let blocks = usize::from(width.div_ceil(8)) * usize::from(height.div_ceil(8));
    let mut bytes = vec![0xFF, 0xD8];
    let mut segment = |marker: u8, content: &[u8]| {
        bytes.extend([0xFF, marker]);
        bytes.extend((content.len() as u16 + 2).to_be_bytes());
        bytes.extend(content);
    };
    segment(0xDB, &[&[0][..], &[16; 64]].concat());
    let [w1, w0] = width.to_be_bytes();
    let [h1, h0] = height.to_be_bytes();
    let frame = if scans == Scans::Sequential { 0xC0 } else { 0xC2 };
    segment(frame, &[8, h1, h0, w1, w0, 1, 1, 0x11, 0]);
    // One code of one bit each. DC: difference 0. AC: "the next 16,384 blocks and more are zero", "the next coefficient has one bit", or "the
    // block ends".
    let code = |class: u8, symbol: u8| [&[class, 1][..], &[0; 15], &[symbol]].concat();
    segment(0xC4, &code(0x00, 0x00));
    let symbol = match scans {
        Scans::Refining => 0xE0,
        Scans::Empty => 0x01,
        Scans::Sequential => 0x00,
    };
    segment(0xC4, &code(0x10, symbol));
    let scan = |first: u8, last: u8, bits: u8, data: &Bits| {
        [&[0xFF, 0xDA, 0, 8, 1, 1, 0x00, first, last, bits][..], &data.bytes()].concat()
    };
    let mut data = Bits::default();
    if scans == Scans::Sequential {
        (0..2 * blocks).for_each(|_| data.push(0, 1));
        (0..more + 1).for_each(|_| bytes.extend(scan(0, 63, 0, &data)));
    } else {
        (0..blocks).for_each(|_| data.push(0, 1));
        bytes.extend(scan(0, 0, 0, &data));
        data = if scans == Scans::Refining {
            zeros(blocks)
        } else {
            Bits::default()
        };
        // Without their lowest bit first; then that bit, again and again.
        let refining = std::iter::once(0x01).chain(std::iter::repeat(0x10));
        for bits in refining.take(more) {
            let bits = if scans == Scans::Refining { bits } else { 0 };
            bytes.extend(scan(1, 63, bits, &data));
        }
    }
    bytes.extend([0xFF, 0xD9]);
    bytes
}

/// Runs of blocks that are all zero; the last run is longer than what is left, as a shorter one would need another code.
fn zeros(blocks: usize) -> Bits {
    let mut data = Bits::default();
    let mut left = blocks;
    while left > 0 {
        let run = left.clamp(1 << 14, (1 << 15) - 1);
        data.push(0, 1);
        data.push(run as u32 - (1 << 14), 14);
        left = left.saturating_sub(run);
    }
    data
}

/// A PNG with a colour profile that unpacks to some 300 MB. The packed zeros are those of a black image's own data.
fn with_profile(png: &[u8]) -> Vec<u8> {
    let mut black = Vec::new();
    PngEncoder::new_with_quality(&mut black, CompressionType::Fast, FilterType::NoFilter)
        .write_image(&vec![0; 17_500 * 17_500], 17_500, 17_500, ExtendedColorType::L8)
        .unwrap();
    let chunk = [b"iCCPp\0\0".to_vec(), data_of(&black)].concat();
    let length = (chunk.len() as u32 - 4).to_be_bytes();
    // Behind the header: 8 bytes of signature, 25 of IHDR.
    [&png[..33], &length, &chunk, &crc32(&chunk).to_be_bytes(), &png[33..]].concat()
}

/// The content of all `IDAT` chunks.
fn data_of(png: &[u8]) -> Vec<u8> {
    let (mut data, mut at) = (Vec::new(), 8);
    while let Some(head) = png.get(at..at + 8) {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        if &head[4..] == b"IDAT" {
            data.extend_from_slice(&png[at + 8..at + 8 + length]);
        }
        at += 12 + length;
    }
    data
}

/// Bits as a scan has them: the highest first, 0xFF followed by 0, the rest filled with ones.
#[derive(Default)]
struct Bits(Vec<bool>);

impl Bits {
    fn push(&mut self, value: u32, count: u32) {
        self.0.extend((0..count).rev().map(|i| value >> i & 1 == 1));
    }

    fn bytes(&self) -> Vec<u8> {
        let byte = |bits: &[bool]| (0..8).fold(0u8, |byte, i| byte << 1 | u8::from(*bits.get(i).unwrap_or(&true)));
        let stuffed = |byte: u8| if byte == 0xFF { vec![0xFF, 0] } else { vec![byte] };
        self.0.chunks(8).flat_map(|bits| stuffed(byte(bits))).collect()
    }
}
