//! COLMAP's `cameras.txt`: a line for each camera, of its id, its model, width, height and parameters.
//!
//! Source: COLMAP documentation, "Output Format" and "Camera Models" (`src/colmap/sensor/models.h`). Its pixels count from the corner of the
//! first one, half a pixel before its centre.

use super::Camera;
use super::chosen::chosen;
use scaleproof_core::message::{Message, message};

fn lines(text: &str) -> impl Iterator<Item = Vec<&str>> {
    let lines = text
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.map(|line| line.split_whitespace().collect())
}

/// Returns true if the first line of the text has the form of a `cameras.txt` line.
pub(super) fn is(text: &str) -> bool {
    lines(text).next().is_some_and(|words| match words[..] {
        [id, model, width, height, _, ..] => {
            let is_model = model
                .chars()
                .all(|c| c.is_ascii_uppercase() || "_0123456789".contains(c));
            is_model && [id, width, height].iter().all(|number| number.parse::<u32>().is_ok())
        }
        _ => false,
    })
}

pub(super) fn read(text: &str, name: Option<&str>) -> Result<Camera, Message> {
    let cameras = lines(text).map(|words| (words[0].to_owned(), words)).collect();
    let (id, words) = chosen(cameras, name)?;
    let refuse = |reason: String| message!("not COLMAP's cameras.txt: camera {id}: {reason}");
    let numbers: Option<Vec<f64>> = words.iter().skip(2).map(|word| word.parse().ok()).collect();
    let numbers = numbers.ok_or_else(|| refuse("what follows its model is no list of numbers".into()))?;
    let sizes: Option<Vec<u32>> = words.iter().skip(2).take(2).map(|word| word.parse().ok()).collect();
    let (Some(&[width, height]), Some((_, parameters))) = (sizes.as_deref(), numbers.split_at_checked(2)) else {
        return Err(refuse("its width and height are no whole numbers".into()));
    };
    let model = words.get(1).copied().unwrap_or_default();
    // Whether the model has a single focal length, its number of coefficients, and whether it is a fisheye model.
    let (is_square, count, is_fisheye) = match model {
        "SIMPLE_PINHOLE" => (true, 0, false),
        "PINHOLE" => (false, 0, false),
        "SIMPLE_RADIAL" => (true, 1, false),
        "RADIAL" => (true, 2, false),
        "OPENCV" => (false, 4, false),
        "FULL_OPENCV" => (false, 8, false),
        "OPENCV_FISHEYE" => (false, 4, true),
        "SIMPLE_RADIAL_FISHEYE" => (true, 1, true),
        "RADIAL_FISHEYE" => (true, 2, true),
        other => {
            return Err(refuse(format!(
                "the model {other} is not supported: undistort, or use OPENCV or OPENCV_FISHEYE"
            )));
        }
    };
    let (fx, fy, [cx, cy, coefficients @ ..]) = (match parameters {
        [f, rest @ ..] if is_square => (*f, *f, rest),
        [fx, fy, rest @ ..] if !is_square => (*fx, *fy, rest),
        _ => (0.0, 0.0, &[][..]),
    }) else {
        return Err(refuse(format!(
            "{model} has more parameters than its {}",
            parameters.len()
        )));
    };
    if coefficients.len() != count {
        return Err(refuse(format!(
            "{model} has {count} distortion coefficients, and it has {}",
            coefficients.len()
        )));
    }
    let camera = Camera::pinhole(width, height, fx, fy, cx - 0.5, cy - 0.5);
    let camera = if is_fisheye {
        camera.with_fisheye([0.0; 4])
    } else {
        camera
    };
    Ok(camera.with_distortion(coefficients))
}
