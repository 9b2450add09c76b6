//! Kalibr's camchain YAML: `pinhole` cameras with `radtan` distortion.
//!
//! Source: Kalibr wiki, "Yaml formats" and "Supported models".

use std::collections::BTreeMap;

use serde::Deserialize;

use super::yaml;
use super::{Camera, marks};

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

pub(super) fn read(text: &str) -> Result<Camera, String> {
    let chain: BTreeMap<String, ChainedCamera> = yaml::parse(text, "a Kalibr camchain")?;
    let mut cameras = chain.iter();
    let (Some((name, camera)), more) = (cameras.next(), cameras.next()) else {
        return Err("the camchain has no camera".into());
    };
    if more.is_some() {
        let names = chain.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        return Err(format!(
            "the camchain has several cameras ({names}): copy the one that took the photos into a file of its own"
        ));
    }
    if camera.camera_model != "pinhole" {
        let model = &camera.camera_model;
        return Err(format!(
            "camera_model {model} of {name} is not supported: calibrate with pinhole and radtan"
        ));
    }
    let count = match camera.distortion_model.as_str() {
        "radtan" => 4,
        "none" => 0,
        other => {
            return Err(format!(
                "distortion_model {other} of {name} is not supported: calibrate with pinhole and radtan"
            ));
        }
    };
    let ([fx, fy, cx, cy], true) = (&camera.intrinsics[..], camera.distortion_coeffs.len() == count) else {
        return Err(format!(
            "{name} must have 4 intrinsics (fu, fv, pu, pv) and {count} distortion_coeffs, it has {} and {}",
            camera.intrinsics.len(),
            camera.distortion_coeffs.len()
        ));
    };
    let [width, height] = camera.resolution;
    Ok(Camera::pinhole(width, height, *fx, *fy, *cx, *cy).with_distortion(&camera.distortion_coeffs))
}

pub(super) fn write(camera: &Camera) -> Result<String, String> {
    let &[k1, k2, p1, p2, ref further @ ..] = camera.distortion();
    if further.iter().any(|v| *v != 0.0) {
        return Err(
            "its radtan model has only k1, k2, p1 and p2, and this camera has more: write another format".into(),
        );
    }
    let Camera { fx, fy, cx, cy, .. } = *camera;
    Ok(format!(
        "{}cam0:\n  camera_model: pinhole\n  intrinsics: [{}]\n  distortion_model: radtan\n  distortion_coeffs: [{}]\n  resolution: [{}, {}]\n  \
         rostopic: /cam0/image_raw\n",
        marks::write(camera),
        yaml::list(&[fx, fy, cx, cy]),
        yaml::list(&[k1, k2, p1, p2]),
        camera.width,
        camera.height
    ))
}
