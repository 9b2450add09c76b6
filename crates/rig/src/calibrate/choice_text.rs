//! What was chosen and what was dropped, in sentences.

use super::Calibration;

/// The chosen model and, for each other, what it would change.
pub fn choice_lines(found: &Calibration) -> Vec<String> {
    let chosen = found.chosen_model();
    let best = found.best_held_out_px();
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
pub fn numbers(found: &Calibration) -> Vec<Number> {
    const NAMES: [&str; 12] = ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
    let c = &found.camera;
    let values = [c.fx, c.fy, c.cx, c.cy].into_iter().chain(*c.distortion());
    let all = NAMES.into_iter().zip(values).zip(found.sigmas).enumerate();
    all.filter(|(i, (_, sigma))| *i < 4 || *sigma > 0.0)
        .map(|(i, ((name, value), sigma))| {
            (
                name,
                value,
                (sigma > 0.0).then_some(sigma),
                if i < 4 { " px" } else { "" },
            )
        })
        .collect()
}
