//! `transforms.json` of NeRF programs: one camera for all frames.
//!
//! Sources: instant-ngp, `scripts/colmap2nerf.py`; nerfstudio documentation, "Data conventions". Their pixels count from the corner of the
//! first one, half a pixel before its centre.

use super::Camera;
use super::fields::Fields;
use scaleproof_core::message::Message;

pub(super) fn is(fields: &Fields) -> bool {
    fields.has("fl_x") || fields.has("camera_angle_x") || (fields.has("frames") && fields.has("camera_model"))
}

pub(super) fn read(fields: Fields) -> Result<Camera, Message> {
    let fields = fields.called("a transforms.json");
    let [width, height] = fields.size()?;
    let number = |name: &str| fields.number(&[name]);
    let sides = [width, height].map(f64::from);
    let of_angle = |angle: f64| sides[0] / 2.0 / (angle / 2.0).tan();
    let fx = match (number("fl_x")?, number("camera_angle_x")?) {
        (Some(fx), _) => fx,
        (None, Some(angle)) => of_angle(angle),
        _ => {
            return Err(
                fields.refuse("it has no fl_x for all frames: each may have its own, and one camera is read".into())
            );
        }
    };
    let fy = number("fl_y")?.unwrap_or(fx);
    let [cx, cy] = [
        number("cx")?.unwrap_or(sides[0] / 2.0) - 0.5,
        number("cy")?.unwrap_or(sides[1] / 2.0) - 0.5,
    ];
    let coefficient = |name: &str| Ok::<f64, Message>(number(name)?.unwrap_or(0.0));
    let [k1, k2, k3, k4] = [
        coefficient("k1")?,
        coefficient("k2")?,
        coefficient("k3")?,
        coefficient("k4")?,
    ];
    let [p1, p2] = [coefficient("p1")?, coefficient("p2")?];
    let camera = Camera::pinhole(width, height, fx, fy, cx, cy);
    match fields.text("camera_model").unwrap_or("OPENCV") {
        "OPENCV_FISHEYE" => Ok(camera.with_fisheye([k1, k2, k3, k4])),
        "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" if k4 != 0.0 => {
            Err(fields.refuse("its k4 has no place in OpenCV's model".into()))
        }
        "OPENCV" | "PINHOLE" | "SIMPLE_PINHOLE" => Ok(camera.with_distortion(&[k1, k2, p1, p2, k3])),
        other => Err(fields.refuse(format!(
            "camera_model {other} is not supported: use OPENCV or OPENCV_FISHEYE"
        ))),
    }
}
