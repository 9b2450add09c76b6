//! How long the frames of a video are exposed, told by the video itself: a tag's side is blurred as far as the camera's motion moves it across itself meanwhile.
//!
//! By that and the motion of a frame it is known how far the model is smeared in it. No blur measured in the frame says so: a camera that goes round a model smears what is near and
//! hardly what is far, and each side tells of the motion across itself alone.

use nalgebra::{Matrix2, Vector2};

use crate::look::Look;

/// What is known of the exposure before a video is seen, s: 1/60, and 0 to 1/40.
const USUAL_S: f64 = 1.0 / 60.0;
/// Fewer sides tell no exposure: those of three frames lie on a line by chance.
const LEAST_SIDES: usize = 40;
/// Rounds of reweighting, and the difference (px²) below which all weigh alike.
const ROUNDS: usize = 15;
const ALIKE_PX2: f64 = 0.02;

/// The exposure of the frames of a video whose motion is set, s, as far as their sides tell it, else as is usual.
///
/// Convolution adds variances: that of a side's blur is what the lens leaves, and the square of the exposure times that of a second. The sum of absolute differences is minimised, as some
/// sides lie in shadow. In four rendered videos it was found longer than it was by a ninth to a sixth, so that frames are rather called smeared than sharp.
pub fn exposure_s(looks: &[Look]) -> f64 {
    let views = looks.iter().filter_map(|look| look.shows.as_ref().ok());
    let moved = views.filter_map(|view| Some((view, view.motion?.per_s)));
    let told = moved.flat_map(|(view, per_s)| view.sides.into_iter().flatten().map(move |side| side.told(&per_s)));
    let usual = USUAL_S.powi(2);
    let of_usual = 1.0 / usual.powi(2);
    let square = match slope(&told.collect::<Vec<_>>()) {
        Some((square, variance)) => {
            let of_video = 1.0 / variance.max(f64::MIN_POSITIVE);
            (square * of_video + usual * of_usual) / (of_video + of_usual)
        }
        None => usual,
    };
    square.max(0.0).sqrt()
}

/// The slope of the line through points (y, x), and its variance by their own scatter; `None` where they leave it open.
fn slope(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    if points.len() < LEAST_SIDES {
        return None;
    }
    let mut line = Vector2::zeros();
    let mut weights = vec![1.0; points.len()];
    let mut inverse = Matrix2::zeros();
    let mut scatter = Matrix2::zeros();
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for ([y, x], weight) in points.iter().zip(&weights) {
            let row = Vector2::new(1.0, *x);
            normal += *weight * row * row.transpose();
            right += *weight * *y * row;
        }
        inverse = normal.try_inverse()?;
        line = inverse * right;
        scatter = Matrix2::zeros();
        for ([y, x], weight) in points.iter().zip(&mut weights) {
            let row = Vector2::new(1.0, *x);
            let off = y - row.dot(&line);
            *weight = 1.0 / off.abs().max(ALIKE_PX2);
            scatter += (*weight * off).powi(2) * row * row.transpose();
        }
    }
    let variance = (inverse * scatter * inverse)[(1, 1)];
    (line[1].is_finite() && variance.is_finite()).then_some((line[1], variance))
}
