//! ROS's `camera_info` YAML.
//!
//! Source: ROS documentation of `camera_calibration_parsers` (keys) and `sensor_msgs/CameraInfo` (models, matrices).

use serde::Deserialize;

use super::opencv_yaml::known_coefficients;
use super::yaml::{self, Matrix};
use super::{Camera, CameraFault, marks};

/// The keys we need; a single camera's rectification and projection follow from them.
#[derive(Deserialize)]
struct RosFile {
    image_width: u32,
    image_height: u32,
    camera_matrix: Matrix,
    /// ROS's own reader takes `plumb_bob` when the key is not there.
    distortion_model: Option<String>,
    distortion_coefficients: Matrix,
}

pub(super) fn read(text: &str) -> Result<Camera, CameraFault> {
    let file: RosFile = yaml::parse(text, "a ROS camera_info file")?;
    let model = file.distortion_model.as_deref().unwrap_or("plumb_bob");
    let limit = match model {
        "plumb_bob" => 5,
        "rational_polynomial" => 8,
        other => return Err(CameraFault::RosModel(other.to_owned())),
    };
    let [fx, fy, cx, cy] = file.camera_matrix.intrinsics("camera_matrix")?;
    let coefficients = file.distortion_coefficients.numbers("distortion_coefficients")?;
    let coefficients = known_coefficients(&coefficients)?;
    if coefficients.iter().skip(limit).any(|v| *v != 0.0) {
        return Err(CameraFault::RosCoefficients {
            model: model.to_owned(),
            limit,
            found: coefficients.len(),
        });
    }
    Ok(Camera::pinhole(file.image_width, file.image_height, fx, fy, cx, cy).with_distortion(coefficients))
}

pub(super) fn write(camera: &Camera) -> String {
    let Camera { fx, fy, cx, cy, .. } = *camera;
    let coefficients = camera.needed_coefficients(&[5, 8]);
    let model = match coefficients.len() {
        8 => "rational_polynomial",
        _ => "plumb_bob",
    };
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let projection = [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0];
    [
        marks::write(camera),
        format!("image_width: {}\nimage_height: {}\n", camera.width, camera.height),
        "camera_name: camera\n".to_owned(),
        matrix("camera_matrix", 3, &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
        format!("distortion_model: {model}\n"),
        matrix("distortion_coefficients", 1, coefficients),
        matrix("rectification_matrix", 3, &identity),
        matrix("projection_matrix", 3, &projection),
    ]
    .concat()
}

fn matrix(name: &str, rows: usize, data: &[f64]) -> String {
    let (cols, data) = (data.len() / rows, yaml::list(data));
    format!("{name}:\n  rows: {rows}\n  cols: {cols}\n  data: [{data}]\n")
}
