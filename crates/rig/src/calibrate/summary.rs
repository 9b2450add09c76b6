//! The calibration for programs, and in sentences: what was chosen and what was dropped.

use serde_json::{Value, json};

use super::{Calibration, CandidateModel, PhotoResult};

/// One JSON object; keys carry their units.
pub fn json(found: &Calibration) -> Value {
    let (c, s) = (&found.camera, &found.sigmas);
    let photo = |p: &PhotoResult| {
        json!({
            "file": p.file,
            "corners": p.corners_px.len(),
            "rms_px": p.rms_px,
            "tilt_deg": p.tilt_deg,
            "distance_mm": p.distance_mm,
            "edge_width_px": p.edge_width_px,
        })
    };
    let model = |(i, r): (usize, &CandidateModel)| {
        json!({
            "model": r.model,
            "parameters": r.model.parameters(),
            "held_out_px": r.held_out_px,
            "held_out_sigma_px": r.error_px,
            "is_chosen": i == found.chosen,
            "moves": r.moves,
        })
    };
    let photos: Vec<Value> = found.photos.iter().map(photo).collect();
    let ladder: Vec<Value> = found.models.iter().enumerate().map(model).collect();
    json!({
        "board": found.board,
        "image_width_px": c.width,
        "image_height_px": c.height,
        "model": found.chosen_model().model,
        "fx_px": c.fx, "fy_px": c.fy, "cx_px": c.cx, "cy_px": c.cy,
        "fx_sigma_px": s[0], "fy_sigma_px": s[1], "cx_sigma_px": s[2], "cy_sigma_px": s[3],
        "distortion": c.distortion(),
        "distortion_sigma": s[4..],
        "rms_px": found.rms_px,
        "held_out_px": found.chosen_model().held_out_px,
        "ladder": ladder,
        "photos": photos,
        "left_out": found.left_out,
        "lost_corners": found.lost_corners,
        "coverage_10x10": found.coverage,
        "cautions": found.cautions,
    })
}

/// The photos, the choice of the model and the camera's numbers as lines of text.
pub fn table(found: &Calibration) -> String {
    let mut text = format!(
        "{:<28} {:>7} {:>8} {:>11} {:>9}\n",
        "photo", "corners", "tilt", "distance", "rms"
    );
    for p in &found.photos {
        let (corners, tilt, distance, rms) = (p.corners_px.len(), p.tilt_deg, p.distance_mm, p.rms_px);
        text += &format!(
            "{:<28} {corners:>7} {tilt:>7.1}° {distance:>8.1} mm {rms:>6.3} px\n",
            p.file
        );
    }
    for line in choice_lines(found) {
        text += &format!("{line}\n");
    }
    for (name, value, sigma, unit) in numbers(found) {
        text += &match sigma {
            Some(sigma) => format!("{name:<3} {value:>11.4} ± {sigma:.4}{unit}\n"),
            None => format!("{name:<3} {value:>11.4}{unit} (held)\n"),
        };
    }
    text
}

/// The chosen model and, for each other, what it would change.
fn choice_lines(found: &Calibration) -> Vec<String> {
    let chosen = found.chosen_model();
    let best = found.models.iter().map(|r| r.held_out_px).fold(f64::INFINITY, f64::min);
    let mut lines = vec![format!(
        "model: {} ({} numbers), held-out error {:.3} px, {:.1} % above the best of the ladder",
        chosen.model.name(),
        chosen.model.parameters(),
        chosen.held_out_px,
        100.0 * (chosen.held_out_px / best - 1.0)
    )];
    for (i, model) in found.models.iter().enumerate().filter(|(i, _)| *i != found.chosen) {
        let verdict = if i < found.chosen { "too small" } else { "not needed" };
        lines.push(format!(
            "dropped {}: {verdict}, held-out error {:.3} px; it would move the camera by up to {:.3}° in azimuth and {:.2} mm ({:.3} %) in distance",
            model.model.name(),
            model.held_out_px,
            model.moves.direction_deg,
            model.moves.distance_mm,
            model.moves.distance_percent
        ));
    }
    lines
}

/// A number of the camera: its name, value, standard deviation (`None` where the model holds it) and unit.
pub(super) type Number = (&'static str, f64, Option<f64>, &'static str);

/// The camera's numbers; coefficients that the model does not have are left out.
pub(super) fn numbers(found: &Calibration) -> Vec<Number> {
    const NAMES: [&str; 12] = ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
    let all = NAMES
        .into_iter()
        .zip(found.camera.parameters())
        .zip(found.sigmas)
        .enumerate();
    let known = all.filter(|(i, (_, sigma))| *i < 4 || *sigma > 0.0);
    let number = |(i, ((name, value), sigma))| {
        let unit = if i < 4 { " px" } else { "" };
        (name, value, (sigma > 0.0).then_some(sigma), unit)
    };
    known.map(number).collect()
}
