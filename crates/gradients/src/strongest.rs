//! The prediction that an attack works against.

use super::whitebox::{Boxes, ForwardPass, ImageLoss, Prediction};
use scaleproof_core::geometry::BoxPx;

/// A box meets the model from this overlap with the box around its mask. Less than a hit's 0.5, so that a box does not
/// win by moving a little; others, such as those of cars in the background, never drive the loss.
pub const MEETS_IOU: f64 = 0.3;

/// The most confident prediction that is reported as the model and overlaps `outline` so much; `None` when no box does. A prediction that is not a number is
/// the most confident, so that it is found and refused instead of passed over.
pub fn strongest(predictions: &[Prediction], outline: &BoxPx, least_iou: f64) -> Option<usize> {
    let meets = |p: &Prediction| !p.confidence.is_finite() || (p.is_reported && p.box_px.iou(outline) >= least_iou);
    let candidates = (0..predictions.len()).filter(|i| meets(&predictions[*i]));
    let order = |i: &usize| {
        let confidence = predictions[*i].confidence;
        if confidence.is_nan() { f64::INFINITY } else { confidence }
    };
    candidates.max_by(|a, b| order(a).total_cmp(&order(b)))
}

impl ImageLoss {
    /// Computes the loss of the predictions that meet the model; `None` where none does.
    pub fn from_pass(pass: Box<dyn ForwardPass + '_>, outline: &BoxPx, boxes: Boxes) -> Option<ImageLoss> {
        let predictions = pass.predictions();
        let worst = strongest(predictions, outline, MEETS_IOU)?;
        let Prediction { confidence, loss, .. } = predictions[worst];
        let mut weights = vec![0.0; predictions.len()];
        let loss = match boxes {
            Boxes::Strongest => {
                weights[worst] = 1.0;
                loss
            }
            _ if !loss.is_finite() => loss,
            Boxes::All | Boxes::Overlap => loss_of_all(predictions, loss, outline, boxes, &mut weights),
        };
        let gradient = pass.vjp(&weights);
        Some(ImageLoss {
            loss,
            confidence,
            gradient,
        })
    }
}

/// `ln(1 + Σ w · odds(C))` over the boxes that meet the model, which is `−ln(1 − C)` where there is one, and its derivative with respect to the loss of
/// each. `highest`: the loss of the strongest.
fn loss_of_all(predictions: &[Prediction], highest: f64, outline: &BoxPx, boxes: Boxes, weights: &mut [f64]) -> f64 {
    // Relative to the strongest, so that nothing overflows: 1 + odds is e^loss.
    let mut sum = (-highest).exp();
    for (prediction, weight) in predictions.iter().zip(weights.iter_mut()) {
        let iou = prediction.box_px.iou(outline);
        if !prediction.is_reported || iou < MEETS_IOU {
            continue;
        }
        let share = if boxes == Boxes::Overlap { iou } else { 1.0 };
        let one_and_odds = (prediction.loss - highest).exp();
        *weight = share * one_and_odds;
        sum += share * (one_and_odds - (-highest).exp()).max(0.0);
    }
    weights.iter_mut().for_each(|weight| *weight /= sum);
    highest + sum.ln()
}
