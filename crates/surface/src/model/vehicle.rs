//! Usual lengths of vehicles, and sizes of one that lies on its side.

use std::ops::RangeInclusive;

use scaleproof_core::geometry::length::number;

/// Length of the longest vehicle on a road, an articulated bus, mm.
pub const LONGEST_MM: f64 = 25_000.0;

/// Returns how a length, width and height in mm are odd for a vehicle that stands on its wheels.
pub fn lies_oddly([length, width, height]: [f64; 3]) -> Option<String> {
    // A box on its side is as good as a box; meshes are not exact.
    let exceeds = |a: f64, b: f64| a > 1.001 * b;
    let [length_text, width_text, height_text] = [length, width, height].map(|mm| number(mm.round()));
    // A wall or a sheet is no vehicle.
    if width.min(height).min(length) < 0.01 * width.max(height).max(length) {
        return None;
    }
    if exceeds(width, length) {
        Some(format!("{length_text} mm long and {width_text} mm wide"))
    } else {
        exceeds(height, width).then(|| format!("taller ({height_text} mm) than wide ({width_text} mm)"))
    }
}

/// Returns the lengths of real ones with this label, mm.
pub fn usual_mm(label: &str) -> RangeInclusive<f64> {
    match label {
        "car" => 2_000.0..=8_000.0,
        "truck" | "bus" => 3_000.0..=LONGEST_MM,
        // From a cup to a train.
        _ => 50.0..=500_000.0,
    }
}

/// Returns true for a length in mm at which nobody would wonder for one of the labels: a mesh's unit is recognised by it.
pub fn is_clearly_usual(labels: &[String], real_mm: f64) -> bool {
    labels.iter().any(|label| {
        let usual_mm = match &**label {
            "car" => 3_300.0..=5_700.0,
            other => usual_mm(other),
        };
        usual_mm.contains(&real_mm)
    })
}
