//! Lengths that were probably meant in another unit, or in another order: a note, never a refusal.

use scaleproof_plot::lettering::number;
use scaleproof_pose::scene::VEHICLES;
use scaleproof_surface::model::vehicle::{LONGEST_MM, lies_oddly, usual_mm};

/// No template is smaller than a stamp.
const STAMP_MM: f64 = 10.0;

pub(crate) fn note(doubt: Option<String>) {
    if let Some(doubt) = doubt {
        say!("note: {doubt}");
    }
}

/// About the size of a template of a model 1:`scale`.
pub(crate) fn template(size_mm: (f64, f64), tile_mm: f64, scale: f64) -> Option<String> {
    let (width, height) = size_mm;
    let longest = width.max(height);
    let size = sides(&[width, height], " × ");
    let times = |factor: f64| format!("--size-mm {}", sides(&[width * factor, height * factor], "x"));
    if longest < STAMP_MM {
        let meant = times(1000.0 / scale);
        return Some(format!(
            "the template is {size} mm: were these metres? At 1:{} that is {meant}",
            number(scale)
        ));
    }
    if longest < tile_mm {
        let (tile, meant) = (number(tile_mm), times(10.0));
        return Some(format!(
            "the template of {size} mm is smaller than one repeat of the pattern ({tile} mm): was it in cm? That is {meant}"
        ));
    }
    (scale > 1.0 && longest * scale > LONGEST_MM).then(|| {
        let (metres, meant) = (metres(longest * scale), times(1.0 / scale));
        format!(
            "the template of {size} mm covers {metres} of the real thing: is that its full size? At 1:{} it is {meant}",
            number(scale)
        )
    })
}

/// About the size of a model, 1:`scale` (length, width, height), whichever of the labels it is.
pub(crate) fn model(labels: &[String], size_mm: [f64; 3], scale: f64) -> Option<String> {
    let doubts = labels.iter().map(|label| model_of(label, size_mm, scale));
    doubts.collect::<Option<Vec<String>>>()?.into_iter().next()
}

fn model_of(class: &str, size_mm: [f64; 3], scale: f64) -> Option<String> {
    // Buses and lorries are taller than wide.
    let [length, width, height] = size_mm;
    let height = if class == "car" { height } else { height.min(width) };
    if VEHICLES.contains(&class)
        && let Some(odd) = lies_oddly([length, width, height])
    {
        return Some(format!("the {class} is {odd}: the order is length x width x height"));
    }
    let real_mm = size_mm.into_iter().fold(0.0, f64::max) * scale;
    let usual_mm = usual_mm(class);
    let is_usual = |mm: f64| usual_mm.contains(&mm);
    if is_usual(real_mm) {
        return None;
    }
    let units = [
        ("cm", 10.0),
        ("metres of the real thing", 1000.0 / scale),
        ("mm of the real thing", 1.0 / scale),
        ("metres", 1000.0),
    ];
    let begin = format!(
        "the {class} of {} mm at 1:{} would be {} long in reality",
        sides(&size_mm, " × "),
        number(scale),
        metres(real_mm)
    );
    let meant = units.into_iter().find(|(_, factor)| is_usual(real_mm * factor));
    Some(match meant {
        Some((unit, factor)) => {
            let size = sides(&size_mm.map(|mm| mm * factor), "x");
            format!("{begin}: were these {unit}? That is --model-size-mm {size}")
        }
        None => format!("{begin}: are --model-size-mm and --scale right?"),
    })
}

pub(crate) fn sides(sides: &[f64], between: &str) -> String {
    let sides: Vec<_> = sides.iter().map(|mm| number((mm * 100.0).round() / 100.0)).collect();
    sides.join(between)
}

/// The size of the real thing: `4.57 × 1.97 × 1.4 m`.
pub(crate) fn real(size_mm: [f64; 3], scale: f64) -> String {
    format!("{} m", sides(&size_mm.map(|mm| mm * scale / 1000.0), " × "))
}

pub(super) fn metres(mm: f64) -> String {
    format!("{} m", number((mm / 10.0).round() / 100.0))
}

#[cfg(test)]
#[path = "tests/units.rs"]
mod tests;
