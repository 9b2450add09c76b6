//! Camera files as other programs write them (`tests/data/make_cameras.py`), against where those programs see points.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nalgebra::Point3;
use scaleproof_pose::camera::{Camera, CameraFormat};

#[derive(serde::Deserialize)]
struct Seen {
    rays: Vec<[f64; 3]>,
    pixels: Vec<[f64; 2]>,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/cases/cameras")
}

fn truth() -> BTreeMap<String, Seen> {
    serde_json::from_str(&std::fs::read_to_string(folder().join("truth.json")).unwrap()).unwrap()
}

/// The name of a file, and behind a `#` that of its camera.
fn open(name: &str) -> Camera {
    let (file, camera) = name
        .split_once('#')
        .map_or((name, None), |(file, camera)| (file, Some(camera)));
    Camera::open_named(&folder().join(file), camera).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Each file's camera sees points where the program that wrote it does, to 1e-9 px, and so does what we write of it.
#[test]
fn files_of_other_programs_project_as_these_do() {
    let truth = truth();
    assert!(truth.len() >= 25, "{}", truth.len());
    for (name, seen) in &truth {
        let camera = open(name);
        let written = camera.write(CameraFormat::OpenCv).unwrap();
        for camera in [Camera::parse(&written, "again.yaml".as_ref()).unwrap(), camera] {
            assert_eq!([camera.width, camera.height], [1280, 960], "{name}");
            for (ray, pixel) in seen.rays.iter().zip(&seen.pixels) {
                let found = camera.project(&Point3::from(*ray)).unwrap();
                let off = (found[0] - pixel[0]).hypot(found[1] - pixel[1]);
                assert!(off < 1e-9, "{name}: {ray:?} at {found:?}, not {pixel:?}");
            }
        }
    }
}

fn refusal(text: &str) -> String {
    Camera::parse(text, "camera".as_ref()).unwrap_err().to_string()
}

#[test]
fn what_such_files_lack_or_have_too_much_is_said() {
    let text = |name: &str| std::fs::read_to_string(folder().join(name)).unwrap();
    for (file, words) in [
        (
            text("pyyaml.yaml").replace("image_size", "date"),
            "how large the image is: add image_width",
        ),
        (
            text("pyyaml.yaml").replace("dist_coeff", "rms"),
            "no distortion_coefficients",
        ),
        (text("kalibr_two.yaml"), "several cameras (cam0, cam1)"),
        (text("colmap.txt"), "several cameras (1, 2, 3"),
        (
            "1 THIN_PRISM_FISHEYE 1280 960 1 2 3 4 5 6 7 8 9 10 11 12".into(),
            "THIN_PRISM_FISHEYE is not supported",
        ),
        (
            "1 OPENCV 1280 960 1180 1180 640 480 0.1".into(),
            "OPENCV has 4 distortion coefficients, and it has 1",
        ),
        (
            text("transforms.json")
                .replace("fl_x", "f_x")
                .replace("camera_angle_x", "angle")
                .replace("frames", "frames\": [], \"camera_model"),
            "no fl_x for all frames",
        ),
        (
            text("transforms.json").replace("\"k4\": 0", "\"k4\": 0.1"),
            "k4 has no place",
        ),
        (
            "K: !!python/object/apply:numpy.core.multiarray._reconstruct [1]".into(),
            "dump lists, as camera_matrix.tolist()",
        ),
        (text("opencv.xml").replace("</data>", ""), "not an XML camera file"),
        ("<html></html>".into(), "not a camera file: give one of OpenCV"),
    ] {
        let said = refusal(&file);
        assert!(said.contains(words) && !said.contains('\n'), "{said}");
    }
    let none = Camera::open_named(&folder().join("kalibr_two.yaml"), Some("cam2"))
        .unwrap_err()
        .to_string();
    assert!(none.contains("it has no camera cam2; it has cam0, cam1"), "{none}");
}

/// What would take the parser the square of its length.
#[test]
fn xml_of_many_attributes_or_namespaces_is_refused_at_once() {
    let storage = |inner: &str| format!("<?xml version=\"1.0\"?><opencv_storage>{inner}</opencv_storage>");
    let attributes: String = (0..200_000).map(|i| format!(" b{i}=\">\"")).collect();
    let open: String = (0..20_000).map(|i| format!("<a xmlns:b{i}=\"u{i}\">")).collect();
    for (text, word) in [
        (storage(&format!("<a{attributes}/>")), "attributes"),
        (storage(&(open + &"</a>".repeat(20_000))), "namespaces"),
    ] {
        let said = Camera::parse(&text, "camera.xml".as_ref()).unwrap_err().to_string();
        assert!(said.contains(word), "{said}");
    }
}
