//! Whether a mesh is a vehicle of a usual size that stands on its wheels.

use crate::cli::units;
use scaleproof_pose::scene::Classes;

/// About a mesh of this size that may lie on its side. Buses and lorries are taller than wide.
pub(super) fn on_its_side(class: Option<&Classes>, size_mm: [f64; 3]) -> Option<String> {
    let is_car = class.is_none_or(|class| class.labels().iter().all(|label| label == "car"));
    let odd = units::lies_as_a_vehicle(size_mm).filter(|_| is_car)?;
    Some(format!(
        "the model is {odd}: are its front and its top right (--mesh-front, --mesh-up)?"
    ))
}

/// About a mesh of this length, 1:`scale`, whichever of the labels it is.
pub(super) fn meshed(class: &Classes, length_mm: f64, scale: f64) -> Option<String> {
    let real_mm = length_mm * scale;
    let is_usual = class
        .labels()
        .iter()
        .any(|label| units::usual_mm(label).contains(&real_mm));
    (!is_usual).then(|| {
        format!(
            "the {class} would be {} long in reality: are --length-mm and --scale right?",
            units::metres(real_mm)
        )
    })
}

/// Whether nobody would wonder at one of this length, mm: what a mesh's unit is recognised by.
pub(super) fn is_clearly_usual(class: &Classes, real_mm: f64) -> bool {
    class.labels().iter().any(|label| {
        let usual_mm = match &**label {
            "car" => 3_300.0..=5_700.0,
            other => units::usual_mm(other),
        };
        usual_mm.contains(&real_mm)
    })
}
