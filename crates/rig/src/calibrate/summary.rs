//! The calibration for programs.

use serde_json::{Value, json};

use super::Calibration;

/// One JSON object; keys carry their units.
pub fn json(found: &Calibration) -> Value {
    let (c, s) = (&found.camera, &found.sigmas);
    let photos: Vec<Value> = found
        .photos
        .iter()
        .map(|p| {
            json!({
                "file": p.file,
                "corners": p.corners_px.len(),
                "rms_px": p.rms_px,
                "tilt_deg": p.tilt_deg,
                "distance_mm": p.distance_mm,
                "edge_width_px": p.edge_width_px,
            })
        })
        .collect();
    let ladder: Vec<Value> = found
        .models
        .iter()
        .enumerate()
        .map(|(i, r)| {
            json!({
                "model": r.model,
                "parameters": r.model.parameters(),
                "held_out_px": r.held_out_px,
                "held_out_sigma_px": r.error_px,
                "is_chosen": i == found.chosen,
                "moves": r.moves,
            })
        })
        .collect();
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
