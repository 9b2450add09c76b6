//! Kalibr's camchain YAML and EuRoC's `sensor.yaml`: `pinhole` cameras with `radtan` (there `radial-tangential`) or `equidistant` distortion.
//!
//! Sources: Kalibr wiki, "Yaml formats" and "Supported models"; the EuRoC MAV data set (Burri et al. 2016), `cam0/sensor.yaml`.

use super::chosen::chosen;
use super::fields::Fields;
use super::{Camera, yaml};
use scaleproof_core::message::{Message, bail, message};

/// Keys of which every camera of such a file has at least one.
const OWN: [&str; 2] = ["intrinsics", "distortion_coeffs"];

/// Returns true if the top level of the file is a single camera.
pub(super) fn is_one(fields: &Fields) -> bool {
    OWN.iter().any(|name| fields.has(name))
}

/// Reads the only camera of a camchain, or the one with the given name.
pub(super) fn read_chain(fields: Fields, name: Option<&str>) -> Result<Camera, Message> {
    let cameras = fields.called("a Kalibr camchain").tables_with(&OWN);
    if cameras.is_empty() {
        bail!(
            "not a camera file: give one of OpenCV, ROS, Kalibr, EuRoC, mrcal, COLMAP (cameras.txt) or a NeRF program (transforms.json)"
        );
    }
    let (name, camera) = chosen(cameras, name)?;
    read_one(camera, &name)
}

/// Reads one camera of a camchain, or a file of a single one, as EuRoC's `sensor.yaml`; its extrinsics are ignored.
pub(super) fn read_one(fields: Fields, name: &str) -> Result<Camera, Message> {
    let fields = fields.called("a Kalibr or EuRoC camera");
    let unsupported = |key, model: &str| {
        message!("{key} {model} of {name} is not supported: calibrate with pinhole and radtan or equidistant")
    };
    let text = |key: &'static str| {
        let missing = || fields.refuse(format!("{name} has no {key}"));
        fields.text(key).map(str::to_owned).ok_or_else(missing)
    };
    let (camera_model, distortion_model) = (text("camera_model")?, text("distortion_model")?);
    if camera_model != "pinhole" {
        return Err(unsupported("camera_model", &camera_model));
    }
    let count = match distortion_model.as_str() {
        // Names used by Kalibr and EuRoC.
        "radtan" | "radial-tangential" | "equidistant" => 4,
        "none" => 0,
        other => return Err(unsupported("distortion_model", other)),
    };
    let intrinsics = fields.numbers(&["intrinsics"])?.unwrap_or_default();
    let coefficients = fields
        .numbers(&["distortion_coeffs", "distortion_coefficients"])?
        .unwrap_or_default();
    let ([fx, fy, cx, cy], true) = (&intrinsics[..], coefficients.len() == count) else {
        bail!(
            "{name} must have 4 intrinsics (fu, fv, pu, pv) and {count} distortion_coeffs, it has {intrinsics} and {coefficients}",
            intrinsics = intrinsics.len(),
            coefficients = coefficients.len()
        );
    };
    let [width, height] = fields.size()?;
    let mut pinhole = Camera::pinhole(width, height, *fx, *fy, *cx, *cy);
    if distortion_model == "equidistant" {
        pinhole = pinhole.with_fisheye([0.0; 4]);
    }
    Ok(pinhole.with_distortion(&coefficients))
}

pub(super) fn write(camera: &Camera) -> Result<String, Message> {
    let coefficients = camera.needed_coefficients(&[4]);
    if coefficients.len() > 4 {
        bail!("its radtan model has only k1, k2, p1 and p2, and this camera has more: write another format");
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
