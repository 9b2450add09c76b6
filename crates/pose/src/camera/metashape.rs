//! Agisoft Metashape's XML: the sensors of a project, or a calibration of its own.
//!
//! Source: Agisoft Metashape user manual, appendix "Camera models". Its principal point counts from the middle of the image, its pixels from the
//! corner of the first one, and its p1 and p2 are OpenCV's p2 and p1.

use roxmltree::Node;

use super::chosen::chosen;
use super::{Camera, CameraFault};

pub(super) fn is(root: Node) -> bool {
    ["document", "calibration"].contains(&root.tag_name().name())
}

pub(super) fn read(root: Node, name: Option<&str>) -> Result<Camera, CameraFault> {
    let sensors = root.descendants().filter(|node| node.has_tag_name("sensor"));
    let sensors = sensors.filter_map(|sensor| {
        let all = || sensor.children().filter(|node| node.has_tag_name("calibration"));
        let calibration = all()
            .find(|node| node.attribute("class") == Some("adjusted"))
            .or(all().next())?;
        let label = sensor.attribute("label").or(sensor.attribute("id"))?;
        Some((label.to_owned(), calibration))
    });
    let mut calibrations: Vec<(String, Node)> = sensors.collect();
    if root.has_tag_name("calibration") {
        calibrations.push((String::new(), root));
    }
    let (_, calibration) = chosen(calibrations, name)?;
    camera(calibration)
}

fn camera(calibration: Node) -> Result<Camera, CameraFault> {
    let refuse = |reason: String| CameraFault::Syntax {
        what: "a calibration of Metashape",
        reason,
    };
    let child = |name: &str| calibration.children().find(|node| node.has_tag_name(name));
    let text = |name: &str| child(name).and_then(|node| node.text());
    let number = |name: &str| match text(name).map(|text| text.trim().parse::<f64>()) {
        None => Ok(0.0),
        Some(Ok(number)) => Ok(number),
        Some(Err(_)) => Err(refuse(format!("{name} is no number"))),
    };
    let side = |name: &str| {
        let of_resolution = child("resolution").and_then(|node| node.attribute(name));
        let stated = of_resolution
            .or(text(name))
            .and_then(|side| side.trim().parse::<u32>().ok());
        stated.ok_or_else(|| refuse(format!("it has no {name}")))
    };
    let [width, height] = [side("width")?, side("height")?];
    if child("f").is_none() {
        return Err(refuse(
            "it has no f: it may be an older version's, or not adjusted yet".into(),
        ));
    }
    for name in ["b2", "p3", "p4"] {
        if number(name)? != 0.0 {
            return Err(refuse(format!(
                "OpenCV's models have no {name}: calibrate with {name} fixed at 0"
            )));
        }
    }
    let (f, b1) = (number("f")?, number("b1")?);
    let centre = |side: u32, offset: f64| f64::from(side) / 2.0 + offset - 0.5;
    let (cx, cy) = (centre(width, number("cx")?), centre(height, number("cy")?));
    let [k1, k2, k3, k4] = [number("k1")?, number("k2")?, number("k3")?, number("k4")?];
    let [p1, p2] = [number("p2")?, number("p1")?];
    let pinhole = Camera::pinhole(width, height, f + b1, f, cx, cy);
    let kind = calibration.attribute("type").or(text("projection")).unwrap_or("frame");
    match kind {
        "frame" if k4 != 0.0 => Err(refuse(
            "OpenCV's models have no k4 of a frame camera: calibrate with k4 fixed at 0".into(),
        )),
        "frame" => Ok(pinhole.with_distortion(&[k1, k2, p1, p2, k3])),
        "fisheye" if [p1, p2] == [0.0; 2] => Ok(pinhole.with_fisheye([k1, k2, k3, k4])),
        "fisheye" => Err(refuse(
            "OpenCV's fisheye has no p1 and p2: calibrate with them fixed at 0".into(),
        )),
        other => Err(refuse(format!(
            "cameras of the type {other} are not supported: frame and fisheye are"
        ))),
    }
}
