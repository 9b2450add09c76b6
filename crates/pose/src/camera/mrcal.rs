//! mrcal's `.cameramodel`: a Python dictionary as text.
//!
//! Source: mrcal documentation, "Camera model representation in memory and on disk" and "Lens models". Its pixels and its
//! OPENCV models are OpenCV's.

use serde::Deserialize;

use super::{Camera, yaml};
use scaleproof_core::message::{Message, bail};

/// Required keys of the file; extrinsics and calibration inputs are ignored.
#[derive(Deserialize)]
struct MrcalFile {
    lensmodel: String,
    /// fx, fy, cx, cy, then the coefficients.
    intrinsics: Vec<f64>,
    /// Width, height.
    imagersize: [u32; 2],
}

/// Supported models, with their numbers of coefficients.
const MODELS: [(&str, usize); 4] = [
    ("LENSMODEL_PINHOLE", 0),
    ("LENSMODEL_OPENCV4", 4),
    ("LENSMODEL_OPENCV5", 5),
    ("LENSMODEL_OPENCV8", 8),
];

/// Returns true if the text is a dictionary with a `lensmodel`.
pub(super) fn is(text: &str) -> bool {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
    let mut starts = lines.clone().map(str::trim_start).filter(|line| !line.is_empty());
    starts.next().is_some_and(|line| line.starts_with('{')) && lines.clone().any(|line| line.contains("lensmodel"))
}

pub(super) fn read(text: &str) -> Result<Camera, Message> {
    let file: MrcalFile = yaml::parse(&without_bytes(text), "an mrcal cameramodel")?;
    let Some((model, count)) = MODELS.iter().find(|(name, _)| *name == file.lensmodel) else {
        bail!(
            "{} is not supported: convert it to LENSMODEL_OPENCV8 with mrcal-convert-lensmodel",
            file.lensmodel
        );
    };
    let (&[fx, fy, cx, cy, ref coefficients @ ..], true) = (&file.intrinsics[..], file.intrinsics.len() == 4 + count)
    else {
        bail!(
            "{model} has {count} intrinsics, the file has {found}",
            count = 4 + count,
            found = file.intrinsics.len()
        );
    };
    let [width, height] = file.imagersize;
    Ok(Camera::pinhole(width, height, fx, fy, cx, cy).with_distortion(coefficients))
}

/// Converts the dictionary to flow YAML: without comments, and with `''` for each `b'…'`, in which mrcal keeps its inputs.
fn without_bytes(text: &str) -> String {
    let (mut plain, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(['#', '\'', '"']) {
        let (before, from) = rest.split_at(at);
        let is_comment = from.starts_with('#');
        let end = if is_comment { "\n" } else { &from[..1] };
        let length = from[1..].find(end).map_or(from.len(), |i| i + 2);
        let (quoted, after) = from.split_at(length);
        match before.strip_suffix('b') {
            _ if is_comment => plain.extend([before, "\n"]),
            Some(before) => plain.extend([before, "''"]),
            None => plain.extend([before, quoted]),
        }
        rest = after;
    }
    plain + rest
}

pub(super) fn write(camera: &Camera) -> Result<String, Message> {
    if camera.is_fisheye() {
        bail!("its models cannot hold a fisheye lens: write opencv, ros or kalibr");
    }
    let coefficients = camera.needed_coefficients(&[0, 4, 5, 8]);
    let model = MODELS.iter().find(|(_, count)| *count == coefficients.len());
    let mut intrinsics = vec![camera.fx, camera.fy, camera.cx, camera.cy];
    intrinsics.extend(coefficients);
    Ok(format!(
        "{}{{\n    'lensmodel': '{}',\n\n    # fx, fy, cx, cy, then the coefficients in OpenCV's order\n    'intrinsics': [ {} ],\n\n    \
         # the camera's own frame\n    'extrinsics': [ 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 ],\n\n    'imagersize': [ {}, {} ],\n}}\n",
        yaml::write_marks(camera),
        model.map_or("", |(name, _)| name),
        yaml::list(&intrinsics),
        camera.width,
        camera.height
    ))
}
