//! Detections of a pattern in the surrogate renderer's images of the views held out. They guide; what counts are new images, rendered or
//! photographed.

use serde::{Deserialize, Serialize};

use super::augmentation::Augmentation;
use super::cells::Rgb;
use super::loss::{HIT_CONFIDENCE, HIT_IOU};
use super::parallel;
use super::view_set::ViewSet;
use crate::AttackError;
use scaleproof_core::ap::{ImageBoxes, average_precision};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::workers;
use scaleproof_detect::{CandidateBox, SCORE_FLOOR, suppress};
use scaleproof_gradients::{MEETS_IOU, Prediction, WhiteBox, strongest};

/// Figures of predicted images of held-out views: means over views and detectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct HeldOutFigures {
    /// Number of held-out views that were predicted.
    pub views: usize,
    /// AP@0.5 as `score` computes it by default.
    pub ap50: f64,
    /// Share of images with a box on the model (IoU ≥ 0.5) of confidence ≥ 0.5.
    pub hit_rate: f64,
    /// Mean confidence of the most confident box on the model; 0 where there is none.
    pub mean_confidence: f64,
}

/// Judges cells (sRGB, 0 to 1) by the views held out.
pub fn judge(
    view_set: &ViewSet,
    detectors: &[Box<dyn WhiteBox>],
    cells: &[Rgb],
) -> Result<HeldOutFigures, AttackError> {
    judge_images(view_set, detectors, |view| {
        Ok(view_set.textured(view, cells, &Augmentation::NONE).augmented.image)
    })
}

/// Judges any images of the views held out.
pub fn judge_images(
    view_set: &ViewSet,
    detectors: &[Box<dyn WhiteBox>],
    image: impl Fn(usize) -> Result<Vec<Rgb>, AttackError> + Sync,
) -> Result<HeldOutFigures, AttackError> {
    let seen = detect(view_set, detectors, &view_set.judged(), image)?;
    let mean = |of: fn(&ViewDetections) -> f64| seen.iter().map(of).sum::<f64>() / seen.len().max(1) as f64;
    Ok(HeldOutFigures {
        views: view_set.judged().len(),
        ap50: mean(ViewDetections::ap50),
        hit_rate: mean(ViewDetections::hit_rate),
        mean_confidence: mean(ViewDetections::mean_confidence),
    })
}

/// Detections of one detector in some views.
#[derive(Default)]
pub struct ViewDetections {
    /// Confidence of the most confident box on the model, in each view; 0 where there is none.
    pub confidences: Vec<f64>,
    boxes: Vec<ImageBoxes>,
}

impl ViewDetections {
    /// Computes AP@0.5 as `score` does by default.
    pub fn ap50(&self) -> f64 {
        average_precision(&self.boxes, HIT_IOU).map_or(0.0, |found| found.ap)
    }

    /// Returns the share of images with a box on the model (IoU ≥ 0.5) of confidence ≥ 0.5.
    pub fn hit_rate(&self) -> f64 {
        let hits = self.confidences.iter().filter(|c| **c >= HIT_CONFIDENCE);
        hits.count() as f64 / self.confidences.len().max(1) as f64
    }

    pub fn mean_confidence(&self) -> f64 {
        self.confidences.iter().sum::<f64>() / self.confidences.len().max(1) as f64
    }
}

/// Runs every detector on some views.
pub fn detect(
    view_set: &ViewSet,
    detectors: &[Box<dyn WhiteBox>],
    views: &[usize],
    image: impl Fn(usize) -> Result<Vec<Rgb>, AttackError> + Sync,
) -> Result<Vec<ViewDetections>, AttackError> {
    let results = parallel::evaluate_each(workers::thread_count(), detectors, views, |detectors, view| {
        let image = image(*view)?;
        let reported = |detector: &&dyn WhiteBox| {
            let mut predictions = predictions(view_set, *detector, *view, &image)?;
            predictions.retain(|prediction| prediction.is_reported);
            Ok(predictions)
        };
        detectors.iter().map(reported).collect::<Result<Vec<_>, AttackError>>()
    });
    let mut seen: Vec<ViewDetections> = detectors.iter().map(|_| ViewDetections::default()).collect();
    for (view, of_view) in views.iter().zip(results?) {
        let outline = &view_set.views[*view].outline;
        for ((detector, predictions), seen) in detectors.iter().zip(of_view).zip(&mut seen) {
            let found = strongest(&predictions, outline, HIT_IOU);
            seen.confidences.push(found.map_or(0.0, |i| predictions[i].confidence));
            seen.boxes.push(ImageBoxes {
                truths: vec![*outline],
                detections: detections(&predictions, detector.nms_iou()),
                ..ImageBoxes::default()
            });
        }
    }
    Ok(seen)
}

/// Returns the highest confidence of a box that meets the model; 0 where there is none.
pub fn confidence(
    view_set: &ViewSet,
    detector: &dyn WhiteBox,
    view: usize,
    image: &[Rgb],
    outline: &BoxPx,
) -> Result<f64, AttackError> {
    let predictions = predictions(view_set, detector, view, image)?;
    Ok(strongest(&predictions, outline, MEETS_IOU).map_or(0.0, |i| predictions[i].confidence))
}

/// Runs a detector on an image; every confidence is a number.
fn predictions(
    view_set: &ViewSet,
    detector: &dyn WhiteBox,
    view: usize,
    image: &[Rgb],
) -> Result<Vec<Prediction>, AttackError> {
    let failed = |reason| view_set.forward_pass_failed(view, detector, reason);
    let predictions = detector.predictions(image, view_set.size_px(view)).map_err(failed)?;
    if predictions.iter().all(|prediction| prediction.confidence.is_finite()) {
        Ok(predictions)
    } else {
        Err(view_set.not_a_number(view, detector, 0))
    }
}

/// Returns the boxes, with their scores, that scoring would see.
fn detections(predictions: &[Prediction], nms_iou: f64) -> Vec<(f64, BoxPx)> {
    let candidates = predictions.iter().filter(|p| p.confidence >= SCORE_FLOOR);
    let candidates = candidates.map(|prediction| CandidateBox {
        label: 0,
        score: prediction.confidence,
        b: prediction.box_px,
    });
    let kept = suppress(candidates.collect(), nms_iou).into_iter();
    kept.map(|kept| (kept.score, kept.b)).collect()
}
