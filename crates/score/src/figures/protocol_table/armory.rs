//! Armory's rates of an image, and its AP.

use crate::figures::Thresholds;
use scaleproof_core::ap::{ImageBoxes, Ranked};
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmoryRates {
    pub true_positive: f64,
    pub misclassification: f64,
    /// 1 − the other two; below 0 where truths have right and wrong labels.
    pub disappearance: f64,
    pub hallucinations: usize,
}

/// Computes the rates of one image with at least one truth, each with the labels that are right for it; detections must exceed the thresholds.
pub fn armory_rates(truths: &[(&[usize], BoxPx)], detections: &[Detection], least: Thresholds) -> ArmoryRates {
    let Thresholds { confidence, iou } = least;
    let strong = || detections.iter().filter(|d| d.score > confidence);
    let meets = |d: &Detection, truth: &BoxPx| d.box_px.iou(truth) > iou;
    let share = |is_right: bool| {
        let met = truths
            .iter()
            .filter(|(labels, truth)| strong().any(|d| meets(d, truth) && labels.contains(&d.label) == is_right));
        met.count() as f64 / truths.len() as f64
    };
    let (true_positive, misclassification) = (share(true), share(false));
    ArmoryRates {
        true_positive,
        misclassification,
        disappearance: 1.0 - true_positive - misclassification,
        hallucinations: strong()
            .filter(|d| !truths.iter().any(|(_, truth)| meets(d, truth)))
            .count(),
    }
}

/// Computes AP over 11 recalls, as numpy's linspace makes them.
pub fn armory_ap(images: &[ImageBoxes], iou: f64) -> f64 {
    eleven_recalls(&Ranked::new(images, iou.next_up()).curve(|_| 1).unwrap_or_default())
}

/// Computes the mean of the best precision at 11 recalls or beyond, of a curve of (precision, recall).
pub(crate) fn eleven_recalls(curve: &[(f64, f64)]) -> f64 {
    let recall = |i: u32| if i == 10 { 1.0 } else { f64::from(i) * 0.1 };
    let best = |least: f64| {
        let reached = curve.iter().filter(|(_, recall)| *recall >= least);
        reached.map(|(precision, _)| *precision).fold(0.0, f64::max)
    };
    (0..=10).map(|i| best(recall(i))).sum::<f64>() / 11.0
}
