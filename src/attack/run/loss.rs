//! The attack loss of DTA (CVPR 2022, eq. 7), `−ln(1 − max C)`, over the boxes that meet the model, and the confidence below which its gradient fades.

use crate::geometry::BoxPx;
use crate::whitebox::Prediction;

/// A box meets the model from this overlap with the box around its mask. Less than a hit's 0.5, so that a box does not
/// win by moving a little; others, such as those of cars in the background, never drive the loss.
pub(crate) const MEETS_IOU: f64 = 0.3;
/// A hit, as `score` counts it: this overlap, and this confidence.
pub(crate) const HIT_IOU: f64 = 0.5;
pub(crate) const HIT_CONFIDENCE: f64 = 0.5;

/// DTA's loss counted from another confidence than a half: `ln(1 + odds(C) / odds(floor))`, and its derivative with respect to
/// `loss`, which is `−ln(1 − C)`.
///
/// By the logit of C it changes by σ(logit C − logit floor): the gradient fades at `floor`. With a half it is DTA's own, which ignores a box
/// that is no hit any more; AP still counts that box, down to the floor of scoring. `floor` is above 0 and at most a half. All
/// numbers are finite however large `loss` is.
pub(crate) fn from_floor(loss: f64, floor: f64) -> (f64, f64) {
    let times = (1.0 - floor) / floor;
    // odds = e^loss − 1; e^−loss stays finite where that does not.
    let missed = -(-loss).exp_m1();
    let value = loss + ((times - 1.0) * missed).ln_1p();
    let derivative = 1.0 / (1.0 + (-loss).exp() * (1.0 - times) / times);
    (value, derivative)
}

/// The most confident prediction that overlaps `outline` so much; `None` when no box does. A prediction that is not a number is
/// the most confident, so that it is found and refused instead of passed over.
pub(crate) fn strongest(predictions: &[Prediction], outline: &BoxPx, least_iou: f64) -> Option<usize> {
    let meets =
        |prediction: &Prediction| !prediction.confidence.is_finite() || prediction.box_px.iou(outline) >= least_iou;
    let candidates = predictions
        .iter()
        .enumerate()
        .filter(|(_, prediction)| meets(prediction));
    let order = |prediction: &Prediction| {
        if prediction.confidence.is_nan() {
            f64::INFINITY
        } else {
            prediction.confidence
        }
    };
    candidates
        .max_by(|(_, a), (_, b)| order(a).total_cmp(&order(b)))
        .map(|(i, _)| i)
}
