//! OpenCV's FileStorage YAML, with the keys of OpenCV's calibration program.
//!
//! Source: OpenCV documentation, "Camera calibration with OpenCV" and "File Input and Output using XML and YAML files".

use serde::Deserialize;

use super::yaml::{self, Matrix};
use super::{Camera, CameraFault, marks};

/// The keys we need; the others (date, flags, errors) belong to the writers and are passed over.
#[derive(Deserialize)]
struct OpenCvFile {
    image_width: u32,
    image_height: u32,
    camera_matrix: Matrix,
    distortion_coefficients: Matrix,
    #[serde(default)]
    fisheye_model: f64,
}

pub(super) fn read(text: &str) -> Result<Camera, CameraFault> {
    let file: OpenCvFile = yaml::parse(text, "an OpenCV camera file")?;
    if file.fisheye_model != 0.0 {
        return Err(CameraFault::Fisheye);
    }
    let [fx, fy, cx, cy] = file.camera_matrix.intrinsics("camera_matrix")?;
    let distortion = file.distortion_coefficients.numbers("distortion_coefficients")?;
    let distortion = known_coefficients(&distortion)?;
    Ok(Camera::pinhole(file.image_width, file.image_height, fx, fy, cx, cy).with_distortion(distortion))
}

/// At most eight of the coefficients OpenCV knows: k1 k2 p1 p2 (k3 (k4 k5 k6 (s1 s2 s3 s4 (τx τy)))).
pub(super) fn known_coefficients(all: &[f64]) -> Result<&[f64], CameraFault> {
    if ![4, 5, 8, 12, 14].contains(&all.len()) {
        return Err(CameraFault::CoefficientCount(all.len()));
    }
    let (known, further) = all.split_at(all.len().min(8));
    if further.iter().any(|v| *v != 0.0) {
        return Err(CameraFault::ThinPrismOrTilt);
    }
    Ok(known)
}

pub(super) fn write(camera: &Camera) -> String {
    let coefficients = camera.needed_coefficients(&[5, 8]);
    format!(
        "%YAML:1.0\n---\n{}image_width: {}\nimage_height: {}\n{}{}",
        marks::write(camera),
        camera.width,
        camera.height,
        matrix(
            "camera_matrix",
            3,
            3,
            &[camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0]
        ),
        matrix("distortion_coefficients", coefficients.len(), 1, coefficients),
    )
}

fn matrix(name: &str, rows: usize, cols: usize, data: &[f64]) -> String {
    let data = yaml::list(data);
    format!("{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: [ {data} ]\n")
}
