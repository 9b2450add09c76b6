//! Kalibr's camchain YAML: `pinhole` cameras with `radtan` or `equidistant` distortion.
//!
//! Source: Kalibr wiki, "Yaml formats" and "Supported models".

use std::collections::BTreeMap;

use serde::Deserialize;

use super::{Camera, CameraFault, yaml};

/// One camera of the chain; where it stands in the chain does not matter here.
#[derive(Deserialize)]
struct ChainedCamera {
    camera_model: String,
    /// fu, fv, pu, pv for a pinhole; other models have other numbers.
    intrinsics: Vec<f64>,
    distortion_model: String,
    distortion_coeffs: Vec<f64>,
    /// Width, height.
    resolution: [u32; 2],
}

pub(super) fn read(text: &str) -> Result<Camera, CameraFault> {
    let chain: BTreeMap<String, ChainedCamera> = yaml::parse(text, "a Kalibr camchain")?;
    let mut cameras = chain.iter();
    let (Some((name, camera)), more) = (cameras.next(), cameras.next()) else {
        return Err(CameraFault::NoCamera);
    };
    if more.is_some() {
        let names = chain.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        return Err(CameraFault::SeveralCameras { names });
    }
    let unsupported = |key, model: &str| CameraFault::KalibrModel {
        key,
        model: model.to_owned(),
        camera: name.clone(),
    };
    if camera.camera_model != "pinhole" {
        return Err(unsupported("camera_model", &camera.camera_model));
    }
    let count = match camera.distortion_model.as_str() {
        "radtan" | "equidistant" => 4,
        "none" => 0,
        other => return Err(unsupported("distortion_model", other)),
    };
    let ([fx, fy, cx, cy], true) = (&camera.intrinsics[..], camera.distortion_coeffs.len() == count) else {
        return Err(CameraFault::KalibrNumbers {
            camera: name.clone(),
            count,
            intrinsics: camera.intrinsics.len(),
            coefficients: camera.distortion_coeffs.len(),
        });
    };
    let [width, height] = camera.resolution;
    let mut pinhole = Camera::pinhole(width, height, *fx, *fy, *cx, *cy);
    if camera.distortion_model == "equidistant" {
        pinhole = pinhole.with_fisheye([0.0; 4]);
    }
    Ok(pinhole.with_distortion(&camera.distortion_coeffs))
}

pub(super) fn write(camera: &Camera) -> Result<String, CameraFault> {
    let coefficients = camera.needed_coefficients(&[4]);
    if coefficients.len() > 4 {
        return Err(CameraFault::BeyondRadtan);
    }
    let model = if camera.is_fisheye() { "equidistant" } else { "radtan" };
    let Camera { fx, fy, cx, cy, .. } = *camera;
    Ok(format!(
        "{}cam0:\n  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: {model}\n  distortion_coeffs: [{}]\n  resolution: [{}, {}]\n  \
         rostopic: /cam0/image_raw\n",
        yaml::write_marks(camera),
        yaml::list(&[fx, fy, cx, cy]),
        yaml::list(coefficients),
        camera.width,
        camera.height
    ))
}
