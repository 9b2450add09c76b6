//! The two YAML formats that hold a camera as matrices: OpenCV's FileStorage, with the keys of OpenCV's calibration program, and ROS's
//! `camera_info`.
//!
//! Sources: OpenCV documentation, "Camera calibration with OpenCV" and "File Input and Output using XML and YAML files"; ROS documentation of
//! `camera_calibration_parsers` (keys) and `sensor_msgs/CameraInfo` (models, matrices).

use std::borrow::Cow;

use serde::Deserialize;

use super::{Camera, CameraFault, yaml};

/// The keys we need. The others are passed over: date, flags and errors belong to the writers, and the rectification and projection of a single
/// camera follow from the rest.
#[derive(Deserialize)]
struct MatrixFile {
    image_width: u32,
    image_height: u32,
    camera_matrix: Matrix,
    distortion_coefficients: Matrix,
    /// Of ROS, whose own reader takes `plumb_bob` when the key is not there.
    distortion_model: Option<String>,
    /// Of OpenCV.
    #[serde(default)]
    fisheye_model: f64,
}

/// A matrix, row by row.
#[derive(Deserialize)]
struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

pub(super) fn read_opencv(text: &str) -> Result<Camera, CameraFault> {
    let file: MatrixFile = yaml::parse(&without_xml(text), "an OpenCV camera file")?;
    if file.fisheye_model != 0.0 {
        return file.fisheye();
    }
    Ok(file.camera()?.0)
}

/// The keys of [`MatrixFile`] in OpenCV's XML as YAML; other text as it is.
fn without_xml(text: &str) -> Cow<'_, str> {
    if !text.contains("<opencv_storage>") {
        return text.into();
    }
    let element = |of: &str, name: &str| {
        let (_, from) = of.split_once(&format!("<{name}"))?;
        let (_, value) = from.split_once('>')?;
        Some(
            value
                .split_once("</")?
                .0
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(", "),
        )
    };
    let mut yaml = String::new();
    for name in ["image_width", "image_height", "fisheye_model"] {
        yaml.extend(element(text, name).map(|value| format!("{name}: {value}\n")));
    }
    for name in ["camera_matrix", "distortion_coefficients"] {
        let matrix = text.split_once(&format!("<{name}")).map_or("", |(_, from)| from);
        let [rows, cols, data] = ["rows", "cols", "data"].map(|key| element(matrix, key).unwrap_or_default());
        yaml += &format!("{name}: {{rows: {rows}, cols: {cols}, data: [{data}]}}\n");
    }
    yaml.into()
}

pub(super) fn read_ros(text: &str) -> Result<Camera, CameraFault> {
    let mut file: MatrixFile = yaml::parse(text, "a ROS camera_info file")?;
    let model = file.distortion_model.take().unwrap_or_else(|| "plumb_bob".to_owned());
    let limit = match model.as_str() {
        "plumb_bob" => 5,
        "rational_polynomial" => 8,
        // The name of ROS's own calibration program, and that of others.
        "equidistant" | "fisheye" => return file.fisheye(),
        _ => return Err(CameraFault::RosModel(model)),
    };
    let (camera, found) = file.camera()?;
    if camera.distortion().iter().skip(limit).any(|v| *v != 0.0) {
        return Err(CameraFault::RosCoefficients { model, limit, found });
    }
    Ok(camera)
}

impl MatrixFile {
    /// The camera without its coefficients, and these.
    fn parts(self) -> Result<(Camera, Vec<f64>), CameraFault> {
        let [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] = self.camera_matrix.numbers("camera_matrix")?[..] else {
            return Err(CameraFault::NoCameraMatrix);
        };
        let pinhole = Camera::pinhole(self.image_width, self.image_height, fx, fy, cx, cy);
        Ok((
            pinhole,
            self.distortion_coefficients.numbers("distortion_coefficients")?,
        ))
    }

    fn fisheye(self) -> Result<Camera, CameraFault> {
        let (pinhole, coefficients) = self.parts()?;
        let four = coefficients
            .try_into()
            .map_err(|all: Vec<f64>| CameraFault::FisheyeCoefficients(all.len()));
        Ok(pinhole.with_fisheye(four?))
    }

    /// The camera, and how many coefficients were given of the eight at most.
    fn camera(self) -> Result<(Camera, usize), CameraFault> {
        let (pinhole, coefficients) = self.parts()?;
        // k1 k2 p1 p2 (k3 (k4 k5 k6 (s1 s2 s3 s4 (τx τy)))).
        if ![4, 5, 8, 12, 14].contains(&coefficients.len()) {
            return Err(CameraFault::CoefficientCount(coefficients.len()));
        }
        let (known, further) = coefficients.split_at(coefficients.len().min(8));
        if further.iter().any(|v| *v != 0.0) {
            return Err(CameraFault::ThinPrismOrTilt);
        }
        Ok((pinhole.with_distortion(known), known.len()))
    }
}

impl Matrix {
    /// The numbers, as many as rows and columns say.
    fn numbers(self, name: &'static str) -> Result<Vec<f64>, CameraFault> {
        let Matrix { rows, cols, data } = self;
        let found = data.len();
        let is_whole = rows.checked_mul(cols) == Some(found);
        is_whole.then_some(data).ok_or(CameraFault::Matrix {
            name,
            rows,
            cols,
            found,
        })
    }
}

/// The numbers of the camera matrix, row by row.
fn camera_matrix(camera: &Camera) -> [f64; 9] {
    [camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0]
}

pub(super) fn write_opencv(camera: &Camera) -> String {
    let matrix = |name: &str, rows: usize, data: &[f64]| {
        let (cols, data) = (data.len() / rows, yaml::list(data));
        format!("{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: [ {data} ]\n")
    };
    let coefficients = camera.needed_coefficients(&[5, 8]);
    // OpenCV's calibration program writes this key; 0 is what readers take without it.
    let fisheye = if camera.is_fisheye() { "fisheye_model: 1\n" } else { "" };
    format!(
        "%YAML:1.0\n---\n{}image_width: {}\nimage_height: {}\n{fisheye}{}{}",
        yaml::write_marks(camera),
        camera.width,
        camera.height,
        matrix("camera_matrix", 3, &camera_matrix(camera)),
        matrix("distortion_coefficients", coefficients.len(), coefficients),
    )
}

pub(super) fn write_ros(camera: &Camera) -> String {
    let matrix = |name: &str, rows: usize, data: &[f64]| {
        let (cols, data) = (data.len() / rows, yaml::list(data));
        format!("{name}:\n  rows: {rows}\n  cols: {cols}\n  data: [{data}]\n")
    };
    let Camera { fx, fy, cx, cy, .. } = *camera;
    let coefficients = camera.needed_coefficients(&[5, 8]);
    let model = match coefficients.len() {
        4 => "equidistant",
        8 => "rational_polynomial",
        _ => "plumb_bob",
    };
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let projection = [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0];
    [
        yaml::write_marks(camera),
        format!("image_width: {}\nimage_height: {}\n", camera.width, camera.height),
        "camera_name: camera\n".to_owned(),
        matrix("camera_matrix", 3, &camera_matrix(camera)),
        format!("distortion_model: {model}\n"),
        matrix("distortion_coefficients", 1, coefficients),
        matrix("rectification_matrix", 3, &identity),
        matrix("projection_matrix", 3, &projection),
    ]
    .concat()
}
