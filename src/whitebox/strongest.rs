//! The prediction that an attack works against.

use super::{ForwardPass, ImageLoss, Prediction};
use crate::geometry::BoxPx;

/// A box meets the model from this overlap with the box around its mask. Less than a hit's 0.5, so that a box does not
/// win by moving a little; others, such as those of cars in the background, never drive the loss.
pub(crate) const MEETS_IOU: f64 = 0.3;

/// The most confident prediction that is reported as the model and overlaps `outline` so much; `None` when no box does. A prediction that is not a number is
/// the most confident, so that it is found and refused instead of passed over.
pub(crate) fn strongest(predictions: &[Prediction], outline: &BoxPx, least_iou: f64) -> Option<usize> {
    let meets = |p: &Prediction| !p.confidence.is_finite() || (p.is_reported && p.box_px.iou(outline) >= least_iou);
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

impl ImageLoss {
    /// That of the strongest prediction that meets the model; `None` where none does.
    pub(crate) fn of(pass: Box<dyn ForwardPass + '_>, outline: &BoxPx) -> Option<ImageLoss> {
        let worst = strongest(pass.predictions(), outline, MEETS_IOU)?;
        let Prediction { confidence, loss, .. } = pass.predictions()[worst];
        let mut weights = vec![0.0; pass.predictions().len()];
        weights[worst] = 1.0;
        Some(ImageLoss {
            loss,
            confidence,
            gradient: pass.vjp(&weights),
        })
    }
}
