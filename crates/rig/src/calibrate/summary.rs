//! Calibration for programs, and in sentences: the chosen model and the dropped ones.

use schemars::JsonSchema;
use serde::Serialize;

use super::board_photo::UnusedPhoto;
use super::error::CalibrationCaution;
use super::ladder::ModelDifference;
use super::model::LensModel;
use super::result::Calibration;
use scaleproof_pose::board::Definition;

/// `calibrate --json`. Standard deviations are of one sigma: by the scatter of the corners, or by leaving photos out where that is larger.
#[derive(Serialize, JsonSchema)]
pub struct CalibrationAnswer<'a> {
    /// The board, with the keys of its file (board.toml); `null` where the tags of a scene were filmed.
    board: Option<&'a Definition>,
    image_width_px: u32,
    image_height_px: u32,
    /// The chosen lens model.
    model: LensModel,
    /// Focal lengths `fx_px` and `fy_px`, principal point `cx_px` and `cy_px`.
    fx_px: f64,
    fy_px: f64,
    cx_px: f64,
    cy_px: f64,
    /// Standard deviation of `fx_px`; also the next three, of theirs.
    fx_sigma_px: f64,
    fy_sigma_px: f64,
    cx_sigma_px: f64,
    cy_sigma_px: f64,
    /// Distortion coefficients k1, k2, p1, p2, k3, k4, k5, k6; `null` for a fisheye.
    distortion: Option<&'a [f64]>,
    /// Coefficients k1, k2, k3, k4 of a fisheye; `null` for other lenses.
    fisheye: Option<&'a [f64]>,
    /// Standard deviations of `distortion` or `fisheye`.
    distortion_sigma: &'a [f64],
    /// Reprojection error of all corners, root mean square.
    rms_px: f64,
    /// Held-out error of the chosen model: each corner is predicted without having been used.
    held_out_px: f64,
    /// The candidate models, from the smallest up.
    ladder: Vec<CandidateAnswer<'a>>,
    /// The photos that the camera was fitted to.
    photos: Vec<PhotoAnswer<'a>>,
    /// Photos that had no part in the camera, and why.
    left_out: &'a [UnusedPhoto],
    /// Corners rejected as outliers.
    lost_corners: usize,
    /// Corners in each of 10 × 10 cells of the image, row by row.
    coverage_10x10: &'a [u32],
    /// Cautions about the camera, as sentences.
    cautions: &'a [CalibrationCaution],
}

/// A candidate model.
#[derive(Serialize, JsonSchema)]
struct CandidateAnswer<'a> {
    model: LensModel,
    /// Number of parameters that are fitted.
    parameters: usize,
    /// Held-out error of this model, root mean square: each corner is predicted without having been used.
    held_out_px: f64,
    /// Standard error of `held_out_px`.
    held_out_sigma_px: f64,
    is_chosen: bool,
    /// Move of the camera by the model in these photos, at worst.
    moves: &'a ModelDifference,
}

/// A photo of the board.
#[derive(Serialize, JsonSchema)]
struct PhotoAnswer<'a> {
    file: &'a str,
    /// Number of corners of the board that are used.
    corners: usize,
    /// Reprojection error of this photo's corners, root mean square.
    rms_px: f64,
    /// Tilt of the board, or of the scene's table, from facing the camera.
    tilt_deg: f64,
    /// Distance of the board's middle, or of the model's, from the camera.
    distance_mm: f64,
    /// Width of the edges of the board in the image; `null` where it could not be measured.
    edge_width_px: Option<f64>,
}

pub fn answer(found: &Calibration) -> CalibrationAnswer<'_> {
    let (c, s) = (&found.camera, &found.sigmas);
    let photos = found.photos.iter().map(|p| PhotoAnswer {
        file: &p.file,
        corners: p.corners_px.len(),
        rms_px: p.rms_px,
        tilt_deg: p.tilt_deg,
        distance_mm: p.distance_mm,
        edge_width_px: p.edge_width_px,
    });
    let ladder = found.models.iter().enumerate().map(|(i, r)| CandidateAnswer {
        model: r.model,
        parameters: r.model.parameters(),
        held_out_px: r.held_out_px,
        held_out_sigma_px: r.error_px,
        is_chosen: i == found.chosen,
        moves: &r.moves,
    });
    CalibrationAnswer {
        board: found.board.as_ref(),
        image_width_px: c.width,
        image_height_px: c.height,
        model: found.chosen_model().model,
        fx_px: c.fx,
        fy_px: c.fy,
        cx_px: c.cx,
        cy_px: c.cy,
        fx_sigma_px: s[0],
        fy_sigma_px: s[1],
        cx_sigma_px: s[2],
        cy_sigma_px: s[3],
        distortion: (!c.is_fisheye()).then(|| c.distortion()),
        fisheye: c.is_fisheye().then(|| c.distortion()),
        distortion_sigma: &s[4..][..c.distortion().len()],
        rms_px: found.rms_px,
        held_out_px: found.chosen_model().held_out_px,
        ladder: ladder.collect(),
        photos: photos.collect(),
        left_out: &found.left_out,
        lost_corners: found.lost_corners,
        coverage_10x10: &found.coverage,
        cautions: &found.cautions,
    }
}

/// Writes the photos, the choice of the model and the camera's numbers as lines of text.
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

/// Returns lines on the chosen model and on the change by each other model.
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

/// Returns the camera's numbers; coefficients that the model does not have are left out.
pub(super) fn numbers(found: &Calibration) -> Vec<Number> {
    let coefficients = found.camera.distortion_model().names();
    let all = ["fx", "fy", "cx", "cy"]
        .into_iter()
        .chain(coefficients.iter().copied())
        .zip(found.camera.parameters().values)
        .zip(found.sigmas)
        .enumerate();
    let known = all.filter(|(i, (_, sigma))| *i < 4 || *sigma > 0.0);
    let number = |(i, ((name, value), sigma))| {
        let unit = if i < 4 { " px" } else { "" };
        (name, value, (sigma > 0.0).then_some(sigma), unit)
    };
    known.map(number).collect()
}
