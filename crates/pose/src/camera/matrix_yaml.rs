//! Camera files with matrices: OpenCV's FileStorage, with the keys of OpenCV's calibration program; ROS's `camera_info`, as a file or as printed
//! messages; and dumps of Python scripts that calibrate with OpenCV.
//!
//! Sources: OpenCV documentation, "Camera calibration with OpenCV" and "File Input and Output using XML and YAML files"; ROS documentation of
//! `camera_calibration_parsers` (keys) and `sensor_msgs/CameraInfo` (models, matrices).

use super::fields::Fields;
use super::{Camera, yaml};
use scaleproof_core::message::{Message, bail, message};

/// Names of the camera matrix in files of OpenCV, ROS messages, and scripts around OpenCV.
pub(super) const MATRIX: [&str; 5] = ["camera_matrix", "K", "mtx", "intrinsic_matrix", "camera_intrinsics"];
/// Names of the distortion coefficients in the same files.
const COEFFICIENTS: [&str; 6] = [
    "distortion_coefficients",
    "dist_coeffs",
    "dist_coeff",
    "dist",
    "D",
    "distortion",
];

/// Reads a camera file with a matrix. Other keys are ignored: date, flags and errors serve the writers, and the rectification and projection of a
/// single camera follow from the rest.
pub(super) fn read(fields: Fields) -> Result<Camera, Message> {
    let model = fields.text("distortion_model").unwrap_or_default().to_owned();
    let is_of_ros = !model.is_empty();
    let fields = fields.called(if is_of_ros {
        "a ROS camera_info file"
    } else {
        "an OpenCV camera file"
    });
    let limit = match model.as_str() {
        "" | "rational_polynomial" => 8,
        "plumb_bob" => 5,
        // "equidistant" is the name of ROS's own calibration program, "fisheye" that of others.
        "equidistant" | "fisheye" => return fisheye(&fields),
        _ => bail!("distortion_model {model} is not supported: use plumb_bob, rational_polynomial or equidistant"),
    };
    if fields.number(&["fisheye_model"])?.unwrap_or(0.0) != 0.0 {
        return fisheye(&fields);
    }
    let (pinhole, coefficients) = parts(&fields)?;
    // k1 k2 p1 p2 (k3 (k4 k5 k6 (s1 s2 s3 s4 (τx τy)))); an empty list means no distortion.
    if ![0, 4, 5, 8, 12, 14].contains(&coefficients.len()) {
        bail!(
            "distortion_coefficients has {} numbers: OpenCV knows 4, 5 or 8",
            coefficients.len()
        );
    }
    let (known, further) = coefficients.split_at(coefficients.len().min(8));
    if further.iter().any(|v| *v != 0.0) {
        bail!("thin-prism and tilt coefficients are not supported: calibrate with at most 8");
    }
    if is_of_ros && known.iter().skip(limit).any(|v| *v != 0.0) {
        let found = known.len();
        bail!(
            "distortion_model {model} has {limit} coefficients but distortion_coefficients has {found}: is it rational_polynomial?"
        );
    }
    Ok(pinhole.with_distortion(known))
}

/// Returns the camera without distortion, and its coefficients.
fn parts(fields: &Fields) -> Result<(Camera, Vec<f64>), Message> {
    let [width, height] = fields.size()?;
    let matrix = fields.numbers(&MATRIX)?.unwrap_or_default();
    let [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] = matrix[..] else {
        bail!("camera_matrix must be [fx 0 cx; 0 fy cy; 0 0 1], 3 rows of 3");
    };
    let missing = || fields.refuse("it has no distortion_coefficients: add them, or an empty list for none".into());
    let coefficients = fields.numbers(&COEFFICIENTS)?.ok_or_else(missing)?;
    Ok((Camera::pinhole(width, height, fx, fy, cx, cy), coefficients))
}

fn fisheye(fields: &Fields) -> Result<Camera, Message> {
    let (pinhole, coefficients) = parts(fields)?;
    let four = coefficients.try_into().map_err(|all: Vec<f64>| {
        message!(
            "a fisheye has 4 coefficients, k1 to k4, but distortion_coefficients has {}",
            all.len()
        )
    });
    Ok(pinhole.with_fisheye(four?))
}

/// Returns the camera matrix, row by row.
fn camera_matrix(camera: &Camera) -> [f64; 9] {
    [camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0]
}

pub(super) fn write_opencv(camera: &Camera) -> String {
    let matrix = |name: &str, rows: usize, data: &[f64]| {
        let (cols, data) = (data.len() / rows, yaml::list(data));
        format!("{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: [ {data} ]\n")
    };
    let coefficients = camera.needed_coefficients(&[5, 8]);
    // OpenCV's calibration program writes this key; readers assume 0 if it is missing.
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
