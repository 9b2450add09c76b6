//! Doubts about a mesh: that it lies on its side, or is no vehicle of a usual size.

use crate::cli::units;
use scaleproof_pose::scene::Classes;
use scaleproof_surface::model::vehicle;

/// About a mesh of this size that may lie on its side. Buses and lorries are taller than wide.
pub fn on_its_side(class: Option<&Classes>, size_mm: [f64; 3]) -> Option<String> {
    let is_car = class.is_none_or(|class| class.labels().iter().all(|label| label == "car"));
    let odd = vehicle::lies_oddly(size_mm).filter(|_| is_car)?;
    Some(format!(
        "the model is {odd}: are its front and its top right (--mesh-front, --mesh-up)?"
    ))
}

/// About a mesh of this length, 1:`scale`, whichever of the labels it is.
pub fn meshed(class: &Classes, length_mm: f64, scale: f64) -> Option<String> {
    let real_mm = length_mm * scale;
    let is_usual = class
        .labels()
        .iter()
        .any(|label| vehicle::usual_mm(label).contains(&real_mm));
    (!is_usual).then(|| {
        format!(
            "the {class} would be {} long in reality: are --length-mm and --scale right?",
            units::metres(real_mm)
        )
    })
}
