//! Camera files: each format against other readers and round trips, `camera`, and cameras that must fit another photo.

use crate::common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{assert_refused, program, read_json, skyline, stderr, stdout, write};
use nalgebra::Point3;
use opencv::core::{FileStorage, FileStorage_Mode, Mat};
use opencv::prelude::*;
use proptest::prelude::*;
use scaleproof_pose::camera::{Camera, CameraFormat, Guess, SizeError};

fn parse(text: &str) -> Result<Camera, String> {
    Camera::parse(text, Path::new("camera.yaml")).map_err(|e| e.to_string())
}

fn corpus(name: &str) -> String {
    std::fs::read_to_string(common::home().join("fuzz/corpus/camera").join(name)).unwrap()
}

fn camera(arguments: &[&str], paths: &[&Path]) -> Output {
    program().arg("camera").args(arguments).args(paths).output().unwrap()
}

/// Where a camera sees points all over its image and beyond; `None` outside its model.
fn pixels(camera: &Camera) -> Vec<Option<[f64; 2]>> {
    let grid = (-6..=6).flat_map(|x| (-6..=6).map(move |y| [f64::from(x) / 6.0, f64::from(y) / 6.0]));
    grid.map(|[x, y]| camera.project(&Point3::new(x, y, 1.0))).collect()
}

fn furthest_apart(a: &Camera, b: &Camera) -> f64 {
    let apart = |pair: (&Option<[f64; 2]>, &Option<[f64; 2]>)| match pair {
        (Some(a), Some(b)) => (a[0] - b[0]).hypot(a[1] - b[1]),
        (None, None) => 0.0,
        _ => f64::INFINITY,
    };
    pixels(a).iter().zip(&pixels(b)).map(apart).fold(0.0, f64::max)
}

/// Cameras of every number of coefficients.
fn cameras() -> impl Strategy<Value = Camera> {
    let size = (16u32..9000, 16u32..9000);
    let intrinsics = (0.3f64..5.0, 0.99f64..1.01, 0.3f64..0.7, 0.3f64..0.7);
    let coefficients = prop::collection::vec(prop_oneof![Just(0.0), -0.3f64..0.3, -1e-7f64..1e-7], 8);
    let count = prop::sample::select(vec![0usize, 1, 2, 4, 5, 8]);
    let is_fisheye = prop::bool::weighted(0.3);
    let marks = (
        prop::option::of(0.1f64..20.0),
        prop::option::of(prop::array::uniform4(0.0f64..9.0)),
    );
    let lens = (coefficients, count, is_fisheye);
    (size, intrinsics, lens, marks).prop_map(|((w, h), (f, ratio, x, y), (k, n, is_fisheye), (guess, sigma))| {
        let (width, height) = (f64::from(w), f64::from(h));
        let focal = f * width.max(height);
        let pinhole = Camera::pinhole(w, h, focal, focal * ratio, x * width, y * height);
        let lens = if is_fisheye {
            pinhole.with_fisheye([0.0; 4])
        } else {
            pinhole
        };
        let mut camera = lens.with_distortion(&k[..n]);
        camera.guess = guess.map(|focal_percent| Guess { focal_percent });
        camera.sigma_px = sigma;
        camera
    })
}

proptest! {
    /// From any format into any other and back: the same numbers, the same projection, or a refusal of what the format cannot say.
    #[test]
    fn every_format_round_trips(camera in cameras()) {
        let beyond_radtan = camera.distortion()[4..].iter().any(|k| *k != 0.0);
        for (first, name) in CameraFormat::ALL {
            let Ok(text) = camera.write(first) else {
                let cannot_say = first == CameraFormat::Kalibr && beyond_radtan || first == CameraFormat::Mrcal && camera.is_fisheye();
                prop_assert!(cannot_say, "{name} refused {camera:?}");
                continue;
            };
            let once = parse(&text).unwrap();
            prop_assert_eq!(&once, &camera);
            for (second, _) in CameraFormat::ALL {
                let Ok(text) = once.write(second) else { continue };
                let twice = parse(&text).unwrap();
                prop_assert!(furthest_apart(&twice, &camera) <= 1e-9);
            }
        }
    }

    /// A pure resize keeps every ray; turning four times is no turn; and a turned image shows each point turned.
    #[test]
    fn scaling_and_turning_move_pixels_as_the_picture_does(camera in cameras(), factor in 0.2f64..3.0) {
        let side = |s: u32| (f64::from(s) * factor).round().max(1.0) as u32;
        let (w, h) = (side(camera.width), side(camera.height));
        let scaled = camera.for_photo(w, h, 0).unwrap().camera;
        let (sx, sy) = (f64::from(w) / f64::from(camera.width), f64::from(h) / f64::from(camera.height));
        for (a, b) in pixels(&camera).into_iter().zip(pixels(&scaled)) {
            let moved = a.map(|[x, y]| [(x + 0.5) * sx - 0.5, (y + 0.5) * sy - 0.5]);
            prop_assert_eq!(moved.is_some(), b.is_some());
            let ([ax, ay], [bx, by]) = (moved.unwrap_or_default(), b.unwrap_or_default());
            prop_assert!((ax - bx).hypot(ay - by) < 1e-6);
        }
        let (w, h) = (camera.width, camera.height);
        for turned_deg in [90, 180, 270] {
            let (tw, th) = if turned_deg == 180 { (w, h) } else { (h, w) };
            let turned = camera.for_photo(tw, th, turned_deg).unwrap().camera;
            for (x, y) in [(0.1, 0.3), (-0.2, 0.15), (0.05, -0.25)] {
                let seen = camera.project(&Point3::new(x, y, 1.0));
                let (right, bottom) = (f64::from(w) - 1.0, f64::from(h) - 1.0);
                let expected = seen.map(|[u, v]| match turned_deg {
                    90 => [bottom - v, u],
                    180 => [right - u, bottom - v],
                    _ => [v, right - u],
                });
                let [x, y] = match turned_deg {
                    90 => [-y, x],
                    180 => [-x, -y],
                    _ => [y, -x],
                };
                let found = turned.project(&Point3::new(x, y, 1.0));
                prop_assert_eq!(expected.is_some(), found.is_some());
                let ([ax, ay], [bx, by]) = (expected.unwrap_or_default(), found.unwrap_or_default());
                prop_assert!((ax - bx).hypot(ay - by) < 1e-6, "{}°: {:?} {:?}", turned_deg, expected, found);
            }
        }
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC*", file in 0usize..4, at in 0usize..700, word in "\\PC{0,6}") {
        let _ = parse(&text);
        let good = corpus(["opencv.yaml", "ros.yaml", "kalibr.yaml", "mrcal.cameramodel"][file]);
        let at = (0..=at.min(good.len())).rev().find(|i| good.is_char_boundary(*i)).unwrap();
        let _ = parse(&good[..at]);
        let _ = parse(&format!("{}{word}{}", &good[..at], &good[at..]));
    }
}

/// OpenCV's own reader and writer.
#[test]
fn opencv_reads_what_we_write_and_we_read_what_opencv_writes() {
    let folder = tempfile::tempdir().unwrap();
    let ours = Camera::pinhole(4000, 3000, 3141.592653589793, 3142.25, 2001.1, 1498.7);
    for coefficients in [
        &[-0.08, 0.03, 1e-7, -2.5e-5][..],
        &[0.1, 0.2, 0.001, -0.002, 0.3, -0.4, 0.5, 1e-9],
    ] {
        let mut camera = ours.clone().with_distortion(coefficients);
        camera.guess = Some(Guess { focal_percent: 6.5 });
        let path = write(folder.path(), "ours.yaml", camera.write(CameraFormat::OpenCv).unwrap());
        let storage = FileStorage::new_def(path.to_str().unwrap(), FileStorage_Mode::READ as i32).unwrap();
        let matrix = |name: &str| storage.get(name).unwrap().mat().unwrap();
        let k = matrix("camera_matrix");
        assert_eq!(*k.at_2d::<f64>(0, 0).unwrap(), camera.fx);
        assert_eq!(*k.at_2d::<f64>(1, 1).unwrap(), camera.fy);
        assert_eq!(
            [*k.at_2d::<f64>(0, 2).unwrap(), *k.at_2d::<f64>(1, 2).unwrap()],
            [camera.cx, camera.cy]
        );
        let d = matrix("distortion_coefficients");
        let d: &[f64] = d.data_typed().unwrap();
        assert_eq!(
            d.len(),
            if coefficients.len() == 8 { 8 } else { 5 },
            "a reader of 5 must not meet 8"
        );
        assert_eq!(d, &camera.distortion()[..d.len()]);
        assert_eq!(storage.get("image_width").unwrap().to_i32().unwrap(), 4000);

        let path = folder.path().join("theirs.yaml");
        let mut storage = FileStorage::new_def(path.to_str().unwrap(), FileStorage_Mode::WRITE as i32).unwrap();
        storage.write_i32("image_width", 4000).unwrap();
        storage.write_i32("image_height", 3000).unwrap();
        let k = Mat::from_slice_2d(&[[ours.fx, 0.0, ours.cx], [0.0, ours.fy, ours.cy], [0.0, 0.0, 1.0]]).unwrap();
        storage.write_mat("camera_matrix", &k).unwrap();
        let d = Mat::from_slice_2d(&[coefficients]).unwrap();
        storage.write_mat("distortion_coefficients", &d).unwrap();
        storage.release().unwrap();
        let theirs = Camera::open(&path).unwrap();
        assert_eq!(theirs, ours.clone().with_distortion(coefficients));
    }
}

/// PyYAML, which ROS's and Kalibr's tools read with, takes every number for a number.
#[test]
fn a_yaml_1_1_reader_finds_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let camera = Camera::pinhole(640, 480, 500.0, 501.0, 319.5, 239.5).with_distortion(&[1e-7, -2e-9, 0.25, 1e-5]);
    let has_pyyaml = std::process::Command::new("python3")
        .args(["-c", "import yaml"])
        .output();
    let has_pyyaml = has_pyyaml.is_ok_and(|o| o.status.success());
    for (format, keys) in [
        (CameraFormat::Ros, "['distortion_coefficients']['data']"),
        (CameraFormat::Kalibr, "['cam0']['distortion_coeffs']"),
    ] {
        let text = camera.write(format).unwrap();
        let numbers = text
            .lines()
            .filter(|l| l.contains("e-"))
            .flat_map(|l| l.split(['[', ',', ']']));
        for word in numbers.filter(|word| word.contains("e-")) {
            assert!(word.contains('.'), "YAML 1.1 takes {word} for a word");
        }
        if has_pyyaml {
            let path = write(folder.path(), "camera.yaml", &text);
            let code = format!(
                "import yaml; print(sum(yaml.safe_load(open({:?})){keys}))",
                path.to_str().unwrap()
            );
            let output = std::process::Command::new("python3")
                .args(["-c", &code])
                .output()
                .unwrap();
            let sum: f64 = stdout(&output)
                .trim()
                .parse()
                .unwrap_or_else(|_| panic!("{}", stderr(&output)));
            assert_eq!(sum, 1e-7 + -2e-9 + 0.25 + 1e-5);
        }
    }
}

/// mrcal's reader takes no number with a plus sign, and wants the model before its numbers and four keys.
#[test]
fn mrcal_files_have_what_its_reader_wants() {
    for (coefficients, model, count) in [
        (&[][..], "LENSMODEL_PINHOLE", 4),
        (&[0.1, 0.2], "LENSMODEL_OPENCV4", 8),
        (&[0.1, 0.0, 0.0, 0.0, 0.2], "LENSMODEL_OPENCV5", 9),
        (&[0.1, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 1e-12], "LENSMODEL_OPENCV8", 12),
    ] {
        let camera = Camera::pinhole(640, 480, 500.0, 501.0, 319.5, 239.5).with_distortion(coefficients);
        let text = camera.write(CameraFormat::Mrcal).unwrap();
        let at = |word: &str| text.find(word).unwrap_or_else(|| panic!("{word} is not in {text}"));
        assert!(
            at(&format!("'{model}'")) < at("'intrinsics'") && at("'extrinsics'") < at("'imagersize': [ 640, 480 ]")
        );
        let list = text[at("'intrinsics': [") + 15..].split(']').next().unwrap();
        let numbers: Vec<f64> = list.split(',').map(|word| word.trim().parse().unwrap()).collect();
        assert_eq!(numbers.len(), count);
        assert_eq!(numbers[..4], [500.0, 501.0, 319.5, 239.5]);
        assert!(list.split(',').all(|word| !word.trim().starts_with('+')));
    }
}

/// Files as each program's documentation describes them, with own values.
#[test]
fn files_of_every_program_are_read() {
    let ros = parse(&corpus("ros.yaml")).unwrap();
    assert_eq!(
        (ros.width, ros.fx, ros.cy, ros.distortion()[2]),
        (640, 430.2, 227.2, 0.0004)
    );
    let opencv = parse(&corpus("opencv_rational.yaml")).unwrap();
    assert_eq!(
        (opencv.height, opencv.fy, opencv.distortion()[7]),
        (3000, 3142.2, 0.03125)
    );
    assert_eq!(opencv.sigma_px, Some([0.41, 0.42, 0.8, 0.7]));
    let kalibr = parse(&corpus("kalibr.yaml")).unwrap();
    assert_eq!(
        (kalibr.width, kalibr.height, kalibr.fy, kalibr.cx),
        (752, 480, 513.25, 371.5)
    );
    assert_eq!(
        kalibr.distortion(),
        &[-0.21, 0.07, 0.0003, -1.2e-05, 0.0, 0.0, 0.0, 0.0]
    );
    let mrcal = parse(&corpus("mrcal.cameramodel")).unwrap();
    assert_eq!((mrcal.width, mrcal.cx, mrcal.distortion()[5]), (4000, 2012.5, 0.75));
    let unknown = corpus("kalibr.yaml")
        .replace("radtan", "none")
        .replace("[-0.21, 0.07, 0.0003, -1.2e-05]", "[]");
    assert_eq!(parse(&unknown).unwrap().distortion(), &[0.0; 8]);
}

/// Stored files: OpenCV's is written by its own FileStorage; ROS and Kalibr name the same model otherwise.
#[test]
fn fisheyes_of_every_program_are_read_and_written() {
    let (opencv, kalibr) = (
        parse(&corpus("opencv_fisheye.yaml")).unwrap(),
        parse(&corpus("kalibr_equidistant.yaml")).unwrap(),
    );
    let expected =
        Camera::pinhole(1280, 960, 310.0, 312.0, 641.5, 478.25).with_fisheye([0.02, -0.004, 0.0015, -0.0004]);
    assert_eq!(opencv, expected);
    assert_eq!(parse(&corpus("opencv_fisheye.xml")).unwrap(), expected);
    assert_eq!(kalibr, expected);
    for (format, words) in [
        (CameraFormat::OpenCv, "fisheye_model: 1"),
        (CameraFormat::Ros, "distortion_model: equidistant"),
        (CameraFormat::Kalibr, "distortion_model: equidistant"),
    ] {
        let text = expected.write(format).unwrap();
        assert!(text.contains(words), "{text}");
        assert_eq!(parse(&text).unwrap(), expected);
        assert_eq!(
            parse(&text.replace("model: equidistant", "model: fisheye")).is_ok(),
            format != CameraFormat::Kalibr
        );
    }
    let refused = expected.write(CameraFormat::Mrcal).unwrap_err().to_string();
    assert!(
        refused.contains("cannot be written as mrcal: its models cannot hold a fisheye lens"),
        "{refused}"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "fisheye.yaml", corpus("opencv_fisheye.yaml"));
    let shown = stdout(&camera(&["show"], &[&file]));
    assert!(
        shown.contains("fisheye (Kannala–Brandt) with k1 0.02, k2 -0.004, k3 0.0015, k4 -0.0004"),
        "{shown}"
    );
    // 1280 px at 310 px a radian.
    assert!(shown.contains("236.6° × 176.3°"), "{shown}");
    let told: serde_json::Value = serde_json::from_str(&stdout(&camera(&["show", "--json"], &[&file]))).unwrap();
    assert!(told["distortion"].is_null() && told["fisheye"][3] == -0.0004, "{told}");
}

#[test]
fn cameras_that_cannot_be_read_are_refused_in_one_sentence() {
    let (opencv, ros, kalibr, mrcal) = (
        corpus("opencv.yaml"),
        corpus("ros.yaml"),
        corpus("kalibr.yaml"),
        corpus("mrcal.cameramodel"),
    );
    for (text, reason) in [
        (String::new(), "the file is empty"),
        (" \n\n".into(), "the file is empty"),
        ("just text".into(), "not a camera file"),
        (
            format!("{opencv}fisheye_model: 1\n"),
            "a fisheye has 4 coefficients, k1 to k4, but distortion_coefficients has 5",
        ),
        (opencv.replace("cols: 5", "cols: 4"), "says 1 × 4 but has 5 numbers"),
        (opencv.replace("[ 1180.0", "[ -1180.0"), "focal lengths fx -1180"),
        (opencv.replace("[ 1180.0", "[ 1180,0"), "says 3 × 3 but has 10 numbers"),
        (opencv.replace("[ 1180.0", "[ .nan"), "focal lengths fx NaN"),
        (opencv.replace("-0.08", ".inf"), "distortion coefficient inf"),
        (opencv.replace("-0.08", "1e300"), "is no finite number below 1e9"),
        (opencv.replace("1180.0", "1e15"), "focal lengths fx 1000000000000000"),
        (opencv.replace("648.5", "64850"), "lies far outside the image"),
        (
            opencv.replace("image_width: 1280", "image_width: 0"),
            "image size 0×960",
        ),
        (
            opencv.replace("image_width: 1280", "image_width: -3"),
            "not an OpenCV camera file",
        ),
        (
            opencv.replace("image_width: 1280", "image_width: 1280\nimage_width: 640"),
            "duplicate",
        ),
        (opencv.replace("image_height", "image_hight"), "image_height"),
        (
            ros.replace("plumb_bob", "thin_prism"),
            "distortion_model thin_prism is not supported",
        ),
        (
            ros.replace("cols: 5", "cols: 8")
                .replace("-0.0002, 0]", "-0.0002, 0, 1, 2, 3]"),
            "plumb_bob has 5 coefficients",
        ),
        (corpus("kalibr_two.yaml"), "several cameras (cam0, cam1)"),
        (kalibr.replace("radtan", "fov"), "distortion_model fov of cam0"),
        (kalibr.replace("pinhole", "omni"), "camera_model omni of cam0"),
        (kalibr.replace("-0.21, ", ""), "cam0 must have 4 intrinsics"),
        (
            mrcal.replace("'LENSMODEL_OPENCV8'", "'LENSMODEL_CAHVOR'"),
            "LENSMODEL_CAHVOR is not supported",
        ),
        (
            mrcal.replace(
                "'LENSMODEL_OPENCV8'",
                "'LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx=30_Ny=18_fov_x_deg=150'",
            ),
            "LENSMODEL_SPLINED_STEREOGRAPHIC",
        ),
        (
            mrcal.replace("'LENSMODEL_OPENCV8'", "'LENSMODEL_OPENCV5'"),
            "has 9 intrinsics, the file has 12",
        ),
        (
            corpus("guess.yaml").replace("percent: 6.6", "percent: six"),
            "must be followed by 1 number",
        ),
    ] {
        let error = parse(&text).expect_err(&text);
        assert!(error.contains(reason) && !error.contains('\n'), "{error}");
        assert!(error.starts_with("camera.yaml: "), "{error}");
    }
}

#[test]
fn convert_writes_each_format_and_refuses_what_it_cannot_say() {
    let folder = tempfile::tempdir().unwrap();
    let input = skyline().join("camera.yaml");
    let stored = Camera::open(&input).unwrap();
    for format in ["opencv", "ros", "kalibr", "mrcal"] {
        let path = folder.path().join(format!("out.{format}"));
        let output = camera(
            &["convert", "--format", format, "-o", path.to_str().unwrap()],
            &[&input],
        );
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(Camera::open(&path).unwrap(), stored);
    }
    let path = folder.path().join("out.cameramodel");
    let output = camera(&["convert", "-o", path.to_str().unwrap()], &[&input]);
    assert!(output.status.success() && std::fs::read_to_string(&path).unwrap().contains("LENSMODEL_OPENCV4"));
    let path = folder.path().join("out.yaml");
    let path_text = path.to_str().unwrap();
    assert_refused(
        &camera(&["convert", "-o", path_text], &[&input]),
        &["out.yaml", "--format"],
    );
    let copy = write(folder.path(), "copy.yaml", corpus("opencv.yaml"));
    let onto_itself = camera(&["convert", "--format", "ros", "-o", copy.to_str().unwrap()], &[&copy]);
    assert_refused(&onto_itself, &["copy.yaml is an input"]);
    let rational = write(folder.path(), "rational.yaml", corpus("opencv_rational.yaml"));
    let output = camera(&["convert", "--format", "kalibr", "-o", path_text], &[&rational]);
    assert_refused(&output, &["cannot be written as kalibr", "k1, k2, p1 and p2"]);
    assert!(!path.exists());
    let shown = stdout(&camera(&["show"], &[&input]));
    assert!(
        shown.contains("1280 × 960 px") && shown.contains("56.9° × 44.3°"),
        "{shown}"
    );
    assert!(shown.contains("Brown–Conrady with k1 -0.08, k2 0.03"), "{shown}");
    let told: serde_json::Value = serde_json::from_str(&stdout(&camera(&["show", "--json"], &[&input]))).unwrap();
    let (size, focal, view) = (&told["size_px"], &told["focal_px"], &told["field_of_view_deg"]);
    assert_eq!((size[0].as_u64(), size[1].as_u64()), (Some(1280), Some(960)), "{told}");
    assert_eq!(focal[0].as_f64(), Some(1180.0), "{told}");
    assert!((view[0].as_f64().unwrap() - 56.9).abs() < 0.05, "{told}");
    assert!(told["guessed_focal_percent"].is_null(), "{told}");
}

/// The values of an EXIF block.
#[derive(Clone, Copy, Default)]
struct Exif {
    orientation: u16,
    focal_mm: Option<(u32, u32)>,
    equivalent_35_mm: Option<u16>,
    px_per_cm: Option<(u32, u32)>,
    zoom: Option<(u32, u32)>,
    size: Option<(u32, u32)>,
    /// As piexif writes it: without the end of the inner directory.
    is_endless: bool,
}

impl Exif {
    /// The block, little endian (Exif 2.32, 4.6).
    fn block(&self) -> Vec<u8> {
        let mut entries: Vec<(u16, u16, Vec<u8>)> = Vec::new();
        let rational = |(a, b): (u32, u32)| [a.to_le_bytes(), b.to_le_bytes()].concat();
        let mut add = |tag, kind, bytes: Option<Vec<u8>>| entries.extend(bytes.map(|bytes| (tag, kind, bytes)));
        add(0x920A, 5, self.focal_mm.map(rational));
        add(0xA002, 4, self.size.map(|(w, _)| w.to_le_bytes().to_vec()));
        add(0xA003, 4, self.size.map(|(_, h)| h.to_le_bytes().to_vec()));
        add(0xA20E, 5, self.px_per_cm.map(rational));
        add(0xA210, 3, self.px_per_cm.map(|_| vec![3, 0, 0, 0]));
        add(0xA404, 5, self.zoom.map(rational));
        add(
            0xA405,
            3,
            self.equivalent_35_mm
                .map(|f| vec![f.to_le_bytes()[0], f.to_le_bytes()[1], 0, 0]),
        );
        let mut block = b"II*\0\x08\0\0\0\x02\0".to_vec();
        let entry = |block: &mut Vec<u8>, tag: u16, kind: u16, value: u32| {
            block.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
            block.extend([1u32.to_le_bytes(), value.to_le_bytes()].concat());
        };
        entry(&mut block, 0x0112, 3, self.orientation.max(1).into());
        entry(&mut block, 0x8769, 4, 8 + 2 + 24 + 4);
        block.extend([0; 4]);
        block.extend((entries.len() as u16).to_le_bytes());
        let end = vec![0; if self.is_endless { 0 } else { 4 }];
        let data_at = block.len() + 12 * entries.len() + end.len();
        let mut data = Vec::new();
        for (tag, kind, bytes) in entries {
            let value = match kind {
                5 => (data_at + data.len()) as u32,
                _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
            };
            entry(&mut block, tag, kind, value);
            data.extend(if kind == 5 { bytes } else { Vec::new() });
        }
        [block, end, data].concat()
    }

    /// A JPEG file with this block in its APP1 segment.
    fn put_into(&self, jpeg: &[u8]) -> Vec<u8> {
        let block = [b"Exif\0\0".to_vec(), self.block()].concat();
        let length = (block.len() as u16 + 2).to_be_bytes();
        [&jpeg[..2], &[0xFF, 0xE1], &length, &block, &jpeg[2..]].concat()
    }
}

fn jpeg(picture: &image::RgbImage) -> Vec<u8> {
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95)
        .encode_image(picture)
        .unwrap();
    bytes
}

/// A grey photo of 400×300 px with an EXIF block.
fn photo(folder: &Path, exif: Exif) -> PathBuf {
    let path = folder.join("photo.jpg");
    let plain = jpeg(&image::RgbImage::from_pixel(400, 300, image::Rgb([90; 3])));
    std::fs::write(&path, exif.put_into(&plain)).unwrap();
    path
}

#[test]
fn a_camera_is_guessed_from_exif_with_its_bound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("guess.yaml");
    let guess = |exif: Exif| {
        let photo = photo(folder.path(), exif);
        camera(&["guess", "-o", path.to_str().unwrap()], &[&photo])
    };
    // A phone: 26 mm equivalent over the diagonal of 500 px.
    let phone = Exif {
        focal_mm: Some((425, 100)),
        equivalent_35_mm: Some(26),
        ..Exif::default()
    };
    let output = guess(phone);
    assert!(output.status.success(), "{}", stderr(&output));
    let found = Camera::open(&path).unwrap();
    let expected = 26.0 * 500.0 / (36.0f64 * 36.0 + 24.0 * 24.0).sqrt();
    assert!((found.fx - expected).abs() < 1e-9 && found.fx == found.fy);
    assert_eq!(
        (found.width, found.height, found.cx, found.cy),
        (400, 300, 199.5, 149.5)
    );
    // Rounding 1.9 %, diagonal against long side 3.8 %, focus 0.9 %, nominal values 2 %.
    let percent = found.guess.unwrap().focal_percent;
    assert!((8.5..8.8).contains(&percent), "{percent}");
    let long_side = 26.0 * 400.0 / 36.0;
    assert!(
        (long_side / found.fx - 1.0).abs() * 100.0 < percent,
        "the other reading lies within the bound"
    );
    let text = stdout(&output);
    assert!(
        text.contains("focal length ± 8.7 %, so distances ± 7.3 %, azimuths about 0.40° off"),
        "{text}"
    );
    // Fields before a fault in the block are read.
    let endless = Exif {
        is_endless: true,
        ..phone
    };
    assert!(guess(endless).status.success());
    assert_eq!(Camera::open(&path).unwrap().fx, found.fx);
    // Held upright: EXIF turns the image, and the camera is the upright image's.
    for orientation in [6, 8] {
        assert!(guess(Exif { orientation, ..phone }).status.success());
        let turned = Camera::open(&path).unwrap();
        assert_eq!((turned.width, turned.height, turned.fx), (300, 400, found.fx));
    }
    // A camera with a known sensor: 50 mm at 80 px per cm … of a small image.
    let sensor = Exif {
        focal_mm: Some((50, 1)),
        px_per_cm: Some((2000, 1)),
        size: Some((800, 600)),
        ..Exif::default()
    };
    assert!(guess(sensor).status.success());
    let found = Camera::open(&path).unwrap();
    assert!(
        (found.fx - 50.0 * 200.0 / 2.0).abs() < 1e-9,
        "recorded twice as large: {}",
        found.fx
    );
    assert!(
        found.guess.unwrap().focal_percent > 11.0,
        "focus at half a metre alone is 11 % of 50 mm"
    );

    std::fs::remove_file(&path).unwrap();
    for (exif, words) in [
        (Exif::default(), "no focal length"),
        (
            Exif {
                equivalent_35_mm: Some(0),
                ..phone
            },
            "no focal length",
        ),
        (
            Exif {
                equivalent_35_mm: Some(48388),
                ..phone
            },
            "no focal length",
        ),
        (
            Exif {
                zoom: Some((2, 1)),
                ..phone
            },
            "digital zoom of 2.00",
        ),
        (
            Exif {
                size: Some((400, 400)),
                ..phone
            },
            "recorded as 400×400",
        ),
        (
            Exif {
                size: Some((400, 300)),
                ..sensor
            },
            "a sensor 2.00 mm wide",
        ),
        (
            Exif {
                equivalent_35_mm: Some(26),
                ..sensor
            },
            "contradict",
        ),
        (
            Exif {
                focal_mm: Some((1, 0)),
                ..Exif::default()
            },
            "no focal length",
        ),
    ] {
        assert_refused(&guess(exif), &["no camera can be guessed from", "photo.jpg", words]);
    }
    assert!(!path.exists());
    assert_refused(
        &camera(&["guess"], &[&skyline().join("normal_000.jpg")]),
        &["calibrate with a printed board"],
    );
    assert_refused(&camera(&["guess"], &[&skyline().join("none.jpg")]), &["cannot read"]);
}

fn locate(photo: &Path, camera: &Path) -> (serde_json::Value, Output) {
    let output = program()
        .args(["locate", "--json", "--scene"])
        .arg(skyline().join("scene.toml"))
        .arg("--camera")
        .arg(camera)
        .arg(photo)
        .output()
        .unwrap();
    (serde_json::from_str(stdout(&output).trim()).unwrap(), output)
}

/// A photo made smaller, or turned by EXIF, is still where the truth says, and the program says what it did.
#[test]
fn photos_of_another_size_or_turned_by_exif_are_located_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let truth = &read_json(&skyline().join("truth.json"))["photos"][0];
    let camera_file = skyline().join("camera.yaml");
    let original = image::open(skyline().join(truth["file"].as_str().unwrap()))
        .unwrap()
        .to_rgb8();
    let path = folder.path().join("photo.jpg");
    let check = |scale: f64, turned: u64, cautions: usize| {
        let (line, output) = locate(&path, &camera_file);
        assert_eq!(line["status"], "located", "{}", stderr(&output));
        let off = |key: &str| (line[key].as_f64().unwrap() - truth[key].as_f64().unwrap()).abs();
        println!(
            "scale {scale}, turned {turned}°: azimuth off {:.4}°, pitch {:.4}°, distance {:.2} mm",
            off("azimuth_deg"),
            off("pitch_deg"),
            off("distance_mm")
        );
        assert!(off("azimuth_deg") < 0.1 && off("pitch_deg") < 0.1 && off("distance_mm") < 2.0);
        assert_eq!(line["camera_scale"], scale);
        assert_eq!(line["camera_turned_deg"], turned);
        assert_eq!(line["cautions"].as_array().unwrap().len(), cautions);
        assert_eq!(stderr(&output).contains("was scaled by"), cautions == 1);
    };
    let save = |picture: &image::RgbImage, orientation: u16| {
        let exif = Exif {
            orientation,
            ..Exif::default()
        };
        std::fs::write(&path, exif.put_into(&jpeg(picture))).unwrap();
    };
    use image::imageops::{FilterType, resize, rotate90, rotate180, rotate270};
    save(&resize(&original, 960, 720, FilterType::Lanczos3), 1);
    check(0.75, 0, 1);
    // The sensor's image as it is stored, shown turned: the camera was held upright, or upside down.
    for (orientation, turned) in [(6, 90), (3, 180), (8, 270)] {
        save(&original, orientation);
        check(1.0, turned, 0);
    }
    // Turned without EXIF, cropped, or of another shape: refused.
    save(&rotate90(&original), 1);
    let (line, output) = locate(&path, &camera_file);
    assert_eq!(line["code"], "wrong_camera_size");
    assert_refused(&output, &["960×1280", "1280×960", "which way the photo was turned"]);
    save(&image::imageops::crop_imm(&original, 0, 100, 1280, 720).to_image(), 1);
    let (_, output) = locate(&path, &camera_file);
    assert_refused(&output, &["1280×720", "cropped by an unknown amount"]);
    // A camera file for upright photos fits photos that EXIF turned into that shape.
    let sideways = Camera::open(&camera_file)
        .unwrap()
        .for_photo(960, 1280, 90)
        .unwrap()
        .camera;
    let upright = write(
        folder.path(),
        "upright.yaml",
        sideways.write(CameraFormat::OpenCv).unwrap(),
    );
    save(&original, 6);
    let (line, _) = locate(&path, &upright);
    assert_eq!(
        (&line["status"], &line["camera_turned_deg"]),
        (&"located".into(), &0.into())
    );
    // What EXIF turns has the same size either way; a half turn is not lost.
    assert_eq!(rotate180(&rotate180(&original)), original);
    assert_eq!(rotate270(&rotate90(&original)), original);
}

#[test]
fn only_rounding_may_change_an_aspect_ratio() {
    let camera = Camera::pinhole(4000, 3000, 3000.0, 3000.0, 1999.5, 1499.5);
    for (width, height) in [(2000, 1500), (1333, 1000), (667, 500), (8000, 6000)] {
        let scaled = camera.scaled_to(width, height).unwrap();
        assert!(
            (scaled.cx - (f64::from(width) - 1.0) / 2.0).abs() < 1e-9,
            "the middle stays the middle"
        );
    }
    for (width, height) in [(4000, 2250), (2000, 1498), (0, 0), (4000, 0)] {
        assert!(
            matches!(camera.scaled_to(width, height), Err(SizeError::Cropped { .. })),
            "{width}×{height}"
        );
    }
    assert!(matches!(camera.scaled_to(1500, 2000), Err(SizeError::Turned { .. })));
}

/// A guess keeps its mark through every format, and whoever uses it is told.
#[test]
fn a_guessed_camera_is_never_taken_for_a_measured_one() {
    let folder = tempfile::tempdir().unwrap();
    let guessed = write(folder.path(), "guess.yaml", corpus("guess.yaml"));
    let (line, output) = locate(&skyline().join("normal_000.jpg"), &guessed);
    assert_eq!(line["status"], "located");
    assert!(
        line["cautions"][0]
            .as_str()
            .unwrap()
            .contains("guessed from EXIF: distances ± 5.5 %"),
        "{line}"
    );
    assert!(stderr(&output).contains("note: the camera is guessed from EXIF"));
    for format in ["ros", "kalibr", "mrcal"] {
        let path = folder.path().join(format);
        camera(
            &["convert", "--format", format, "-o", path.to_str().unwrap()],
            &[&guessed],
        );
        assert_eq!(
            Camera::open(&path).unwrap().guess.unwrap().focal_percent,
            6.6,
            "{format}"
        );
    }
    let session = common::copy_of_skyline();
    std::fs::copy(&guessed, session.path().join("camera.yaml")).unwrap();
    let out = folder.path().join("out");
    let output = program()
        .arg("score")
        .arg(session.path())
        .args(["--recorded", "--detector", "yolox_nano", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let cautions = read_json(&out.join("summary.json"))["cautions"].to_string();
    assert!(cautions.contains("guessed from EXIF"), "{cautions}");
}
