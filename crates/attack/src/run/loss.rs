//! The attack loss of DTA (CVPR 2022, eq. 7), `−ln(1 − max C)`, and the confidence below which its gradient fades.

/// Least overlap of a hit, as `score` counts it.
pub const HIT_IOU: f64 = 0.5;
/// Least confidence of a hit, as `score` counts it.
pub const HIT_CONFIDENCE: f64 = 0.5;

/// Computes DTA's loss with a floor other than a half: `ln(1 + odds(C) / odds(floor))`, and its derivative with respect to
/// `loss`, which is `−ln(1 − C)`.
///
/// By the logit of C it changes by σ(logit C − logit floor): the gradient fades at `floor`. With a half it is DTA's own, which ignores a box
/// that is no hit any more; AP still counts that box, down to the floor of scoring. `floor` is above 0 and at most a half. All
/// numbers are finite however large `loss` is.
pub fn from_floor(loss: f64, floor: f64) -> (f64, f64) {
    let times = (1.0 - floor) / floor;
    // odds = e^loss − 1; e^−loss stays finite where that does not.
    let missed = -(-loss).exp_m1();
    let value = loss + ((times - 1.0) * missed).ln_1p();
    let derivative = 1.0 / (1.0 + (-loss).exp() * (1.0 - times) / times);
    (value, derivative)
}
