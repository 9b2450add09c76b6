//! The attack loss of DTA (CVPR 2022, eq. 7), `−ln(1 − max C)`, over the boxes that meet the model, and the confidence at which its pull fades.

use crate::geometry::BoxPx;
use crate::whitebox::Claim;

/// A box meets the model from this overlap with the box around its mask. Less than a hit's 0.5, so that a box does not
/// win by moving a little; others, such as those of cars in the background, never drive the loss.
pub const MEETS_IOU: f64 = 0.3;
/// A hit, as `score` counts it: this overlap, and this confidence.
pub const HIT_IOU: f64 = 0.5;
pub const HIT_CONFIDENCE: f64 = 0.5;

/// DTA's loss counted from another confidence than a half: `ln(1 + odds(C) / odds(floor))`, and its derivative with respect to
/// `loss`, which is `−ln(1 − C)`.
///
/// By the logit of C it changes by σ(logit C − logit floor): the pull fades at `floor`. With a half it is DTA's own, which lets go of a box
/// that is no hit any more; AP still counts that box, down to the floor of scoring. `floor` is above 0 and at most a half. All
/// numbers are finite however large `loss` is.
pub fn from_floor(loss: f64, floor: f64) -> (f64, f64) {
    let times = (1.0 - floor) / floor;
    // odds = e^loss − 1; e^−loss stays finite where that does not.
    let missed = -(-loss).exp_m1();
    let value = loss + ((times - 1.0) * missed).ln_1p();
    let slope = 1.0 / (1.0 + (-loss).exp() * (1.0 - times) / times);
    (value, slope)
}

/// The most confident claim that overlaps `outline` so much; `None` when no box does. A claim that is not a number is
/// the most confident, so that it is found and refused instead of passed over.
pub fn strongest(claims: &[Claim], outline: &BoxPx, least_iou: f64) -> Option<usize> {
    let meets = |claim: &Claim| !claim.confidence.is_finite() || claim.box_px.iou(outline) >= least_iou;
    let candidates = claims.iter().enumerate().filter(|(_, claim)| meets(claim));
    let order = |claim: &Claim| {
        if claim.confidence.is_nan() {
            f64::INFINITY
        } else {
            claim.confidence
        }
    };
    candidates
        .max_by(|(_, a), (_, b)| order(a).total_cmp(&order(b)))
        .map(|(i, _)| i)
}
