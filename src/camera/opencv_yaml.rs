//! Reads the camera YAML that OpenCV's FileStorage and ROS's `camera_info` write.
//!
//! Both carry `image_width`, `image_height`, `camera_matrix` and `distortion_coefficients` with `rows`, `cols`, `data`.

use std::path::Path;

use serde::Deserialize;

use super::{Camera, CameraError};
use crate::files;

/// The keys we need; the others (date, flags, errors, rectification) belong to the writers and are passed over.
#[derive(Deserialize)]
struct CameraFile {
    image_width: u32,
    image_height: u32,
    camera_matrix: Matrix,
    distortion_coefficients: Matrix,
    distortion_model: Option<String>,
    #[serde(default)]
    fisheye_model: f64,
}

#[derive(Deserialize)]
struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Camera {
    /// Reads a camera file: OpenCV YAML or ROS `camera_info` YAML.
    pub fn open(path: &Path) -> Result<Camera, CameraError> {
        Camera::parse(&files::read_text(path)?, path)
    }

    /// Parses the text of a camera file; `path` is only named in errors.
    pub fn parse(text: &str, path: &Path) -> Result<Camera, CameraError> {
        let refuse = |message: String| CameraError::Content {
            path: path.to_owned(),
            message,
        };
        let file: CameraFile = serde_saphyr::from_str(&plain_yaml(text)).map_err(|e| {
            let reason = e.to_string();
            refuse(format!("not an OpenCV or ROS camera file: {}", plain_reason(&reason)))
        })?;
        checked(file).map_err(refuse)
    }
}

/// The first line of what the parser says, without its own "error: line …" frame.
fn plain_reason(reason: &str) -> &str {
    let line = reason.lines().next().unwrap_or_default();
    line.split_once("column ")
        .map_or(line, |(_, rest)| rest.split_once(": ").map_or(rest, |(_, what)| what))
}

/// OpenCV writes `%YAML:1.0`, which is no YAML directive, and a tag that only OpenCV knows.
fn plain_yaml(text: &str) -> String {
    let body = match text.split_once('\n') {
        Some((first, rest)) if first.starts_with("%YAML") => rest,
        _ => text,
    };
    body.replace("!!opencv-matrix", "")
}

fn checked(file: CameraFile) -> Result<Camera, String> {
    if file.fisheye_model != 0.0 {
        return Err("a fisheye model is not supported: calibrate with the pinhole model".into());
    }
    if let Some(model) = file
        .distortion_model
        .filter(|m| m != "plumb_bob" && m != "rational_polynomial")
    {
        return Err(format!(
            "distortion_model {model} is not supported: use plumb_bob or rational_polynomial"
        ));
    }
    if file.image_width == 0 || file.image_height == 0 {
        return Err("image_width and image_height must be above 0".into());
    }
    let k = numbers(file.camera_matrix, "camera_matrix")?;
    let [fx, skew, cx, _, fy, cy, ..] = k[..] else {
        return Err("camera_matrix must have 3 rows and 3 columns".into());
    };
    if k.len() != 9 || fx <= 0.0 || fy <= 0.0 || skew != 0.0 || k[3] != 0.0 || k[6..] != [0.0, 0.0, 1.0] {
        return Err("camera_matrix must be [fx 0 cx; 0 fy cy; 0 0 1] with fx and fy above 0".into());
    }
    let distortion = numbers(file.distortion_coefficients, "distortion_coefficients")?;
    // The lengths OpenCV knows: k1 k2 p1 p2 (k3 (k4 k5 k6 (s1 s2 s3 s4 (τx τy)))).
    if ![4, 5, 8, 12, 14].contains(&distortion.len()) {
        return Err(format!(
            "distortion_coefficients has {} numbers: OpenCV knows 4, 5 or 8",
            distortion.len()
        ));
    }
    if distortion.len() > 8 && distortion[8..].iter().any(|v| *v != 0.0) {
        return Err("thin-prism and tilt coefficients are not supported: calibrate with at most 8".into());
    }
    Ok(Camera::pinhole(file.image_width, file.image_height, fx, fy, cx, cy).with_distortion(&distortion))
}

fn numbers(matrix: Matrix, name: &str) -> Result<Vec<f64>, String> {
    if matrix.rows.checked_mul(matrix.cols) != Some(matrix.data.len()) {
        let (rows, cols, found) = (matrix.rows, matrix.cols, matrix.data.len());
        return Err(format!("{name} says {rows} × {cols} but has {found} numbers"));
    }
    if matrix.data.iter().any(|v| !v.is_finite()) {
        return Err(format!("{name} has a number that is not finite"));
    }
    Ok(matrix.data)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const OPENCV: &str = "%YAML:1.0
---
calibration_time: \"Fri 20 Nov 2026\"
image_width: 1280
image_height: 960
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 1180.0, 0.0, 648.5, 0.0, 1.1805e+03, 473.5,
       0.0, 0.0, 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -8.0e-02, 0.03, 0., 0.0, 0.0 ]
";

    const ROS: &str = "image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [430.2, 0, 306.7, 0, 430.5, 227.2, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.34, 0.11, 0.0004, -0.0002, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
";

    fn parse(text: &str) -> Result<Camera, String> {
        Camera::parse(text, Path::new("camera.yaml")).map_err(|e| e.to_string())
    }

    #[test]
    fn opencv_and_ros_files_read() {
        let camera = parse(OPENCV).unwrap();
        assert_eq!(
            (camera.width, camera.fx, camera.fy, camera.cx, camera.cy),
            (1280, 1180.0, 1180.5, 648.5, 473.5)
        );
        assert_eq!(camera.distortion()[..2], [-0.08, 0.03]);
        let camera = parse(ROS).unwrap();
        assert_eq!((camera.height, camera.fx, camera.distortion()[2]), (480, 430.2, 0.0004));
    }

    #[test]
    fn cameras_we_cannot_model_are_refused() {
        for (text, reason) in [
            (ROS.replace("plumb_bob", "equidistant"), "distortion_model equidistant"),
            (OPENCV.replace("rows: 5", "rows: 4"), "says 4 × 1 but has 5 numbers"),
            (OPENCV.replace("data: [ 1180.0", "data: [ -1180.0"), "fx and fy above 0"),
            (OPENCV.replace("image_width: 1280", "image_width: 0"), "above 0"),
            (
                OPENCV.replace("image_height", "image_hight"),
                "not an OpenCV or ROS camera file",
            ),
            (format!("{OPENCV}fisheye_model: 1\n"), "fisheye"),
            ("just text".into(), "not an OpenCV or ROS camera file"),
        ] {
            let error = parse(&text).unwrap_err();
            assert!(error.contains(reason) && !error.contains('\n'), "{error}");
        }
    }

    proptest! {
        #[test]
        fn parsing_never_panics(text in "\\PC*", at in 0usize..500) {
            let _ = parse(&text);
            let _ = parse(OPENCV.get(..at.min(OPENCV.len())).unwrap_or(OPENCV));
        }
    }
}
